/**
 * @file
 * One run of a target: what both ways of running it share.
 */
#include "run.h"

volatile sig_atomic_t epg_host_interrupted;

void epg_host_run_start(epg_host_run_t *run, const epg_application_t *application)
{
    /* Plant first: starting the application samples the sensors and starts the decoders where the shafts stand. */
    epg_plant_start(&run->plant, run->host->plant, application->period_ns);
    epg_control_start(run->host->target->control, application);
    epg_plant_actuate(&run->plant);
}

void epg_host_run_end(epg_host_run_t *run, uint64_t tick_ns, uint64_t next_ns)
{
    const epg_application_t *application = run->host->target->application;
    const bool complete = next_ns >= run->end_ns;
    run->ran_ns = complete ? run->end_ns : next_ns;
    run->missed_at_end = complete ? (run->end_ns - 1 - tick_ns) / application->period_ns : 0;
    application->safe();
    epg_plant_actuate(&run->plant);
}
