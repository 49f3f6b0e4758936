/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Simulated time: one thread, no waiting, the same result every time.
 *
 * Nothing here depends on how fast the machine is: a cycle takes no simulated time, unless a `$stall` event says
 * that one does.  The computation time that the statistics report is measured beside, by the monotonic clock.
 */
#include "clock.h"
#include "run.h"

/** The run at hand, for read_and_stall(): the application's functions take no argument. */
static struct {
    epg_host_run_t *run;
    epg_application_t application; /* the target's, with read_and_stall() in place of read() */
    uint64_t now_ns;
    uint64_t outside_ns; /* monotonic time spent within a cycle on what is not the cycle: plant and communication */
} simulation;

static void set_time(uint64_t time_ns)
{
    simulation.now_ns = time_ns;
    epg_host_clock_simulate(time_ns);
}

/** Communication and plant have come to `time_ns`, the plant driven by the outputs as they are. */
static void move_on(uint64_t time_ns)
{
    epg_host_communicate_simulated(&simulation.run->communication, time_ns);
    epg_plant_advance(&simulation.run->plant, time_ns);
    set_time(time_ns);
}

/**
 * Samples the sensors; then, when a stall is due, time passes before anything is computed from the samples, as if
 * an interrupt of higher priority had come in between.
 */
static void read_and_stall(void)
{
    simulation.run->host->target->application->read();
    const uint64_t stall_ns = simulation.run->communication.stall_ns;
    if (stall_ns > 0) {
        const uint64_t entered_ns = epg_host_monotonic_ns();
        simulation.run->communication.stall_ns = 0;
        move_on(simulation.now_ns + stall_ns);
        simulation.outside_ns += epg_host_monotonic_ns() - entered_ns;
    }
}

const epg_application_t *epg_host_prepare_simulated(epg_host_run_t *run)
{
    simulation.run = run;
    simulation.application = *run->host->target->application;
    simulation.application.read = read_and_stall;
    set_time(0);
    return &simulation.application;
}

/** The cycle of `tick_ns`, now. */
static void cycle(epg_host_run_t *run, uint64_t tick_ns, uint32_t missed)
{
    const uint64_t begun_ns = simulation.now_ns;
    simulation.outside_ns = 0;
    const uint64_t entered_ns = epg_host_monotonic_ns();
    epg_control_cycle(run->host->target->control, tick_ns, missed);
    const uint64_t spent_ns = epg_host_monotonic_ns() - entered_ns - simulation.outside_ns;
    epg_plant_actuate(&run->plant);
    epg_host_timing_add(&run->timing, begun_ns - tick_ns, spent_ns);
    epg_host_trace_add(&run->trace, tick_ns, begun_ns - tick_ns, simulation.now_ns - begun_ns);
}

void epg_host_run_simulated(epg_host_run_t *run)
{
    const uint64_t entered_ns = epg_host_monotonic_ns();
    const uint64_t period_ns = run->host->target->application->period_ns;
    uint64_t tick_ns = 0;
    uint64_t next_ns = 0;
    uint32_t missed = 0;
    run->scheduler = "simulated";
    while (next_ns < run->end_ns && !epg_host_interrupted) {
        tick_ns = next_ns;
        move_on(simulation.now_ns > tick_ns ? simulation.now_ns : tick_ns);
        if (!epg_host_plant_is_sound(run, simulation.now_ns)) {
            break;
        }
        epg_plant_sense(&run->plant);
        cycle(run, tick_ns, missed);
        next_ns = epg_host_next_tick(tick_ns, period_ns, simulation.now_ns, &missed);
    }
    epg_host_run_end(run, tick_ns, next_ns);
    epg_host_communicate_simulated(&run->communication, run->ran_ns);
    run->wall_time_ns = epg_host_monotonic_ns() - entered_ns;
    epg_host_clock_real();
}
