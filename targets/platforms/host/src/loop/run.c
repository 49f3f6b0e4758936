/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A run of a target: the part that simulated time and real time share.
 */
#include "run.h"

#include "diverged.h"

volatile sig_atomic_t epg_host_interrupted;

void epg_host_run_start(epg_host_run_t *run, const epg_application_t *application)
{
    /*
     * The plant first: the start of the application reads the sensors and starts the decoders at the plant's positions.
     */
    epg_plant_start(&run->plant, run->host->plant, application->period_ns);
    epg_control_start(run->host->target->control, application);
    epg_plant_actuate(&run->plant);
}

bool epg_host_plant_is_sound(epg_host_run_t *run, uint64_t time_ns)
{
    const epg_host_target_t *host = run->host;
    for (size_t i = 0; i < host->plant_output_count && run->diverged == NULL; i++) {
        const double value = *host->plant_outputs[i].value;
        if (epg_host_has_diverged(value)) {
            run->diverged = &host->plant_outputs[i];
            run->diverged_value = value;
            run->diverged_ns = time_ns;
        }
    }
    return run->diverged == NULL;
}

void epg_host_run_end(epg_host_run_t *run, uint64_t tick_ns, uint64_t next_ns)
{
    const epg_application_t *application = run->host->target->application;
    const bool complete = next_ns >= run->end_ns;
    run->ran_ns = complete ? run->end_ns : next_ns;
    run->missed_at_end = complete ? (run->end_ns - 1 - tick_ns) / application->period_ns : 0;
    application->safe();
    epg_plant_actuate(&run->plant);
    if (run->diverged != NULL) {
        epg_host_tell_diverged(NULL, run->diverged->name, run->diverged_value, run->diverged_ns);
    }
}
