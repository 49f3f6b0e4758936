/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A run: setpoints, plant and recording around the control cycles of the image.  The functions and their order are
 * those of the platform `host`.
 *
 * Zephyr's clock does not advance while the image computes.  A cycle therefore takes no simulated time, except after a
 * `$stall` event.  In real time the native simulator waits between two ticks of the system clock.
 */
#include <posix_board_if.h>
#include <posix_native_task.h>
#include <zephyr/kernel.h>

#include "epg/plant.h"
#include "epg/port.h"
#include "files/files.h"
#include "loop/run.h"
#include "parts.h"
#include "port/clock.h"
#include "program/report.h"

#define NS_PER_US 1000U
#define LONGEST_WAIT_US 1000000U

static epg_host_run_t run;
static struct {
    epg_application_t application; /* that of Zephyr's port layer, with read_and_stall() in place of read() */
    void (*read)(void);            /* its read(), which read_and_stall() calls */
    epg_host_files_t files;
    bool prepared;
    bool begun;           /* the first cycle has begun */
    bool written;         /* the files are complete */
    uint64_t start_ns;    /* time 0 of the run, as a time of epg_port_time_ns(): the first tick */
    uint64_t tick_ns;     /* tick of the newest cycle, since time 0 */
    uint64_t begun_ns;    /* begin of the newest cycle, since time 0 */
    uint64_t entered_ns;  /* begin of the newest cycle, monotonic time */
    uint64_t outside_ns;  /* monotonic time spent on plant and communication within the cycle, during a stall */
    uint64_t wall_ns;     /* time 0 of the run, monotonic time */
    volatile int stopped; /* the user has pressed Ctrl-C */
} simulation;

static uint64_t now_ns(void)
{
    return epg_port_time_ns() - simulation.start_ns;
}

/* Files ---------------------------------------------------------------------------------------------------------- */

/** Writes the rest of the recorded values and closes the files.  False, with a message, if a file cannot be written. */
static bool close_files(void)
{
    epg_host_trace_end(&run.trace);
    epg_host_communication_end(&run.communication);
    epg_native_sim_close_transports();
    simulation.written = true;
    return epg_host_files_close(&simulation.files, &epg_native_sim_options);
}

/**
 * Runs at each end of the program.  Other code may end it, too (native_sim's -stop_at, the application): write the
 * files.
 */
static void on_exit(void)
{
    if (simulation.prepared && !simulation.written) {
        (void)close_files();
    }
}

NATIVE_TASK(on_exit, ON_EXIT, 10);

/* Begin and end ---------------------------------------------------------------------------------------------------- */

static void prepare(void)
{
    const epg_host_options_t *options = &epg_native_sim_options;
    const epg_host_target_t *host = epg_native_sim_target;
    const uint64_t period_ns = host->target->application->period_ns;
    if (!epg_native_sim_all_emulated() || !epg_host_files_open(&simulation.files, options)) {
        posix_exit(FAILED);
    }
    run = (epg_host_run_t){
        .host = host, .end_ns = options->duration_ns, .scheduler = options->realtime ? "native_sim" : "simulated"};
    if (!epg_host_communication_start(&run.communication, host->target, &epg_native_sim_events, run.end_ns,
                                      simulation.files.topics) ||
        !epg_host_trace_start(&run.trace, host, simulation.files.trace, false, (run.end_ns - 1) / period_ns + 1)) {
        posix_exit(FAILED);
    }
    epg_native_sim_catch_interrupts(&simulation.stopped);
    simulation.prepared = true;
}

/** Ends the run and the program after the last cycle.  The next tick would have been at `next_ns`. */
static void finish(uint64_t next_ns)
{
    const epg_host_options_t *options = &epg_native_sim_options;
    epg_host_interrupted = simulation.stopped;
    epg_host_run_end(&run, simulation.tick_ns, next_ns);
    epg_host_communicate_simulated(&run.communication, run.ran_ns);
    run.wall_time_ns = epg_host_monotonic_ns() - simulation.wall_ns;
    if (simulation.files.statistics != NULL) {
        epg_host_write_statistics(simulation.files.statistics, &run);
    }
    const bool written = close_files();
    if (!options->quiet && !options->console && run.diverged == NULL) {
        epg_host_print_summary(&run);
    }
    posix_exit(!written || run.diverged != NULL ? FAILED : simulation.stopped ? INTERRUPTED : DONE);
}

/*
 * Cycles ------------------------------------------------------------------------------------------------------------
 */

/** Advances communication and plant to the present time.  The plant's inputs stay as they are. */
static void move_on(void)
{
    epg_host_communicate_simulated(&run.communication, now_ns());
    epg_plant_advance(&run.plant, now_ns());
}

/**
 * Replaces the application's read(): samples the sensors.  If a stall is due, simulated time passes before the model
 * computes with the samples, as if an interrupt of a higher priority had delayed the cycle.
 */
static void read_and_stall(void)
{
    simulation.read();
    const uint64_t stall_ns = run.communication.stall_ns;
    if (stall_ns > 0) {
        const uint64_t entered_ns = epg_host_monotonic_ns();
        run.communication.stall_ns = 0;
        for (uint64_t left_us = stall_ns / NS_PER_US; left_us > 0;) {
            const uint32_t wait_us = (uint32_t)MIN(left_us, LONGEST_WAIT_US);
            k_busy_wait(wait_us);
            left_us -= wait_us;
        }
        move_on();
        simulation.outside_ns += epg_host_monotonic_ns() - entered_ns;
    }
}

void epg_native_sim_starting(void)
{
    const epg_host_target_t *host = epg_native_sim_target;
    if (!simulation.prepared) {
        prepare();
        /* The plant first: the start of the application reads the sensors and starts the decoders at its positions. */
        epg_plant_start(&run.plant, host->plant, host->target->application->period_ns);
    } else if (simulation.begun) {
        epg_plant_actuate(&run.plant); /* a second start: the outputs were safe while the target was stopped */
        move_on();
        epg_plant_sense(&run.plant);
    }
}

void epg_native_sim_started(void)
{
    const epg_target_t *target = run.host->target;
    simulation.application = *target->control->application;
    simulation.read = simulation.application.read;
    simulation.application.read = read_and_stall;
    target->control->application = &simulation.application;
    epg_native_sim_shafts_turn();
    epg_native_sim_drive_pins();
    epg_plant_actuate(&run.plant);
}

void epg_native_sim_before_cycle(uint64_t tick_ns)
{
    if (!simulation.begun) {
        simulation.begun = true;
        simulation.start_ns = tick_ns;
        simulation.wall_ns = epg_host_monotonic_ns();
        run.communication.start_ns = tick_ns;
    }
    const uint64_t since_ns = tick_ns - simulation.start_ns;
    if (since_ns >= run.end_ns || simulation.stopped || epg_native_sim_input_ended()) {
        finish(since_ns);
    }
    epg_native_sim_tell_connection();
    move_on();
    if (!epg_host_plant_is_sound(&run, since_ns)) {
        finish(since_ns);
    }
    epg_plant_sense(&run.plant);
    simulation.tick_ns = since_ns;
    simulation.begun_ns = now_ns();
    simulation.outside_ns = 0;
    simulation.entered_ns = epg_host_monotonic_ns();
}

void epg_native_sim_after_cycle(void)
{
    const uint64_t spent_ns = epg_host_monotonic_ns() - simulation.entered_ns - simulation.outside_ns;
    const uint64_t lateness_ns = simulation.begun_ns - simulation.tick_ns;
    epg_plant_actuate(&run.plant);
    epg_host_timing_add(&run.timing, lateness_ns, spent_ns);
    epg_host_trace_add(&run.trace, simulation.tick_ns, lateness_ns, now_ns() - simulation.begun_ns);
}
