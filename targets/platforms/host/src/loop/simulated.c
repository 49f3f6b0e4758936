/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Simulated time: one thread, which does not wait, and gives the same result every time.  Only a run with `pace` waits.
 *
 * The result does not depend on the speed of the computer.  A cycle takes no simulated time, except after a `$stall`
 * event.  The computation time in the statistics is measured separately, by the monotonic clock.
 */
#include "port/clock.h"
#include "run.h"

/** The present run.  It is global for read_and_stall(): functions of an application have no argument. */
static struct {
    epg_host_run_t *run;
    epg_application_t application; /* the target's, with read_and_stall() in place of read() */
    uint64_t now_ns;               /* simulated time */
    uint64_t outside_ns;           /* monotonic time spent on plant and communication within a cycle, during a stall */
} simulation;

static void set_time(uint64_t time_ns)
{
    simulation.now_ns = time_ns;
    epg_host_clock_simulate(time_ns);
}

/** Advances communication and plant to `time_ns`.  The plant's inputs stay as they are. */
static void move_on(uint64_t time_ns)
{
    epg_host_communicate_simulated(&simulation.run->communication, time_ns);
    epg_plant_advance(&simulation.run->plant, time_ns);
    set_time(time_ns);
}

/**
 * Replaces the application's read(): samples the sensors.  If a stall is due, simulated time passes before the model
 * computes with the samples, as if an interrupt of a higher priority had delayed the cycle.
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

/** Runs the cycle of the tick at `tick_ns` at the present simulated time, which may be later. */
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
    if (run->pace > 0.0) {
        epg_host_pace_start(run);
    }
    while (next_ns < run->end_ns && !epg_host_interrupted) {
        tick_ns = next_ns;
        if (run->pace > 0.0) {
            epg_host_pace_wait(run, tick_ns);
        }
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
    if (run->pace > 0.0) {
        epg_host_pace_end(run);
    }
    epg_host_clock_real();
}
