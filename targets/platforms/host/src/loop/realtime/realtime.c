/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Real time: a control thread, which wakes up at absolute times of the monotonic clock.
 */
#include <fenv.h>
#include <stdatomic.h>
#include <stdio.h>

#include "epg/host.h"
#include "loop/run.h"
#include "loop/thread.h"
#include "port/clock.h"

enum {
    START_DELAY_NS = 20 * 1000 * 1000, /* from the thread's start to its first tick: time for the caller to prepare */
    LONGEST_SLEEP_NS = 100 * 1000 * 1000, /* longest sleep of the communication side: it then looks for Ctrl-C */
    WRITE_PERIOD_NS = 100 * 1000 * 1000,  /* from one write of the trace's rows to the next */
    NAP_NS = 100 * 1000                   /* between two looks whether a thread has started */
};

/** A control thread, with the data that it shares with the thread that has started it. */
typedef struct control_thread {
    epg_host_run_t *run;
    epg_host_thread_t thread;
    atomic_bool ready; /* start_ns is known */
    uint64_t start_ns; /* monotonic time of the first tick */
    atomic_bool stop;
    atomic_bool ended; /* the thread has ended by itself */
} control_thread_t;

/**
 * The control loop.  The plant is simulated between two cycles, outside the measured time.  If the plant takes too
 * long, ticks are missed, and they are counted.
 */
static void control_loop(control_thread_t *self)
{
    epg_host_run_t *run = self->run;
    const uint64_t period_ns = run->host->target->application->period_ns;
    uint64_t tick_ns = 0; /* since the first tick, like all times of a run */
    uint64_t next_ns = 0;
    uint32_t missed = 0;
    while (next_ns < run->end_ns && !atomic_load(&self->stop) && epg_host_plant_is_sound(run, next_ns)) {
        tick_ns = next_ns;
        const uint64_t due_ns = self->start_ns + tick_ns;
        while (epg_host_monotonic_ns() < due_ns) {
            epg_host_sleep_until(due_ns);
        }
        const uint64_t begun_ns = epg_host_monotonic_ns();
        epg_control_cycle(run->host->target->control, due_ns, missed);
        const uint64_t ended_ns = epg_host_monotonic_ns();
        epg_plant_actuate(&run->plant);
        epg_host_timing_add(&run->timing, begun_ns - due_ns, ended_ns - begun_ns);
        epg_host_trace_add(&run->trace, tick_ns, begun_ns - due_ns, ended_ns - begun_ns);
        epg_plant_advance(&run->plant, tick_ns + period_ns);
        next_ns = epg_host_next_tick(tick_ns, period_ns, epg_host_monotonic_ns() - self->start_ns, &missed);
        epg_plant_advance(&run->plant, next_ns);
        if (epg_host_plant_is_sound(run, next_ns)) {
            epg_plant_sense(&run->plant);
        }
    }
    epg_host_run_end(run, tick_ns, next_ns);
}

static void control_main(void *argument)
{
    control_thread_t *self = argument;
    (void)fesetenv(FE_DFL_ENV); /* see epg_host_main(): a program of the user's may have another mode */
    self->run->memory_locked = epg_host_thread_prepare();
    self->start_ns = epg_host_monotonic_ns() + START_DELAY_NS;
    atomic_store(&self->ready, true);
    control_loop(self);
    atomic_store(&self->ended, true);
}

/** Starts the control thread and waits until `start_ns` is known.  Returns false, with a message, if this fails. */
static bool start_thread(control_thread_t *self, epg_host_run_t *run)
{
    self->run = run;
    atomic_init(&self->stop, false);
    atomic_init(&self->ended, false);
    atomic_init(&self->ready, false);
    const char *error = epg_host_thread_start_control(&self->thread, control_main, run, self);
    if (error != NULL) {
        fprintf(stderr, "error: cannot start the control thread: %s\n", error);
        return false;
    }
    while (!atomic_load(&self->ready)) {
        epg_host_sleep_until(epg_host_monotonic_ns() + NAP_NS);
    }
    return true;
}

/* The trace ---------------------------------------------------------------------------------------------------- */

/** The thread that writes the trace.  Only this one waits for the disk. */
typedef struct writer {
    epg_host_trace_t *trace;
    epg_host_thread_t thread;
    bool runs;
    atomic_bool stop;
} writer_t;

static void writer_main(void *argument)
{
    writer_t *self = argument;
    while (!atomic_load(&self->stop)) {
        epg_host_sleep_until(epg_host_monotonic_ns() + WRITE_PERIOD_NS);
        epg_host_trace_write(self->trace);
    }
}

/** Starts the thread if there is a trace.  Returns false, with a message, if this fails. */
static bool start_writer(writer_t *self, epg_host_trace_t *trace)
{
    self->trace = trace;
    self->runs = false;
    atomic_init(&self->stop, false);
    if (trace->file == NULL) {
        return true;
    }
    const char *error = epg_host_thread_start(&self->thread, writer_main, self);
    self->runs = error == NULL;
    if (error != NULL) {
        fprintf(stderr, "error: cannot start the thread that writes the trace: %s\n", error);
    }
    return self->runs;
}

static void stop_writer(writer_t *self)
{
    if (self->runs) {
        atomic_store(&self->stop, true);
        epg_host_thread_join(&self->thread);
    }
}

/* A run ---------------------------------------------------------------------------------------------------------- */

/** Sleeps until monotonic time `time_ns`.  With a middleware it sleeps for a shorter time and serves the middleware. */
static void sleep_or_serve(epg_host_run_t *run, uint64_t time_ns)
{
    if (epg_host_services_run(&run->services)) {
        epg_host_services_serve(&run->services, time_ns);
    } else {
        epg_host_sleep_until(time_ns);
    }
}

static bool ended(const epg_host_run_t *run)
{
    return epg_host_interrupted ||
           (run->ends_with_input && epg_host_terminal_ended(run->services.terminal, epg_host_monotonic_ns()));
}

bool epg_host_run_realtime(epg_host_run_t *run)
{
    control_thread_t control;
    epg_host_services_start(&run->services);
    if (!start_thread(&control, run)) {
        return false;
    }
    writer_t writer; /* after the control thread has locked the memory: this thread's need not be locked */
    const bool writes = start_writer(&writer, &run->trace);
    const uint64_t start_ns = control.start_ns;
    uint64_t now_ns = 0;
    run->communication.start_ns = start_ns;
    epg_host_sleep_until(start_ns);
    while (writes && now_ns < run->end_ns && !ended(run) && !atomic_load(&control.ended)) {
        uint64_t until_ns = epg_host_communication_next(&run->communication);
        until_ns = until_ns < now_ns + LONGEST_SLEEP_NS ? until_ns : now_ns + LONGEST_SLEEP_NS;
        sleep_or_serve(run, start_ns + (until_ns < run->end_ns ? until_ns : run->end_ns));
        const uint64_t monotonic_ns = epg_host_monotonic_ns();
        now_ns = monotonic_ns > start_ns ? monotonic_ns - start_ns : 0; /* a signal can end the sleep too early */
        epg_host_communicate_realtime(&run->communication, now_ns);
    }
    atomic_store(&control.stop, now_ns < run->end_ns);
    epg_host_thread_join(&control.thread);
    stop_writer(&writer);
    run->wall_time_ns = epg_host_monotonic_ns() - start_ns;
    epg_host_services_stop(&run->services);
    return writes;
}

/* In a program with its own main() ----------------------------------------------------------------------------- */

static struct {
    bool running;
    epg_host_run_t run;
    control_thread_t control;
    epg_host_thread_t communication;
    bool communicates;
    atomic_bool stop;
} own;

/** Body of the communication thread: serves the middleware until the program stops the target. */
static void communication_main(void *argument)
{
    (void)argument;
    epg_host_services_start(&own.run.services);
    while (!atomic_load(&own.stop)) {
        epg_control_alive(own.run.host->target->control);
        epg_host_services_serve(&own.run.services, UINT64_MAX);
    }
    epg_host_services_stop(&own.run.services);
}

/** Starts the communication thread if the target's middleware has a connection.  Returns false if this fails. */
static bool start_communication(const epg_host_target_t *host)
{
    static const epg_host_options_t options = {.realtime = true, .quiet = true};
    if (epg_host_services_open(&own.run.services, host, &options) != DONE ||
        epg_host_services_identify(&own.run.services) != DONE) {
        return false;
    }
    own.run.services.agent = NULL; /* no messages in a program of the user */
    if (!epg_host_is_connected(host)) {
        return true;
    }
    atomic_init(&own.stop, false);
    own.communicates = epg_host_thread_start(&own.communication, communication_main, NULL) == NULL;
    return own.communicates;
}

static void stop_communication(void)
{
    if (own.communicates) {
        atomic_store(&own.stop, true);
        epg_host_thread_join(&own.communication);
        own.communicates = false;
    }
    epg_host_services_close(&own.run.services);
}

bool epg_host_start(const epg_host_target_t *host)
{
    if (own.running) {
        return false;
    }
    own.run = (epg_host_run_t){.host = host, .end_ns = UINT64_MAX};
    epg_host_run_start(&own.run, host->target->application);
    own.running = start_communication(host) && start_thread(&own.control, &own.run);
    if (!own.running) {
        stop_communication();
    }
    return own.running;
}

bool epg_host_stop(void)
{
    if (own.running) {
        if (epg_host_thread_is_caller(&own.control.thread) ||
            (own.communicates && epg_host_thread_is_caller(&own.communication))) {
            return false; /* a thread cannot wait for its own end */
        }
        stop_communication();
        atomic_store(&own.control.stop, true);
        epg_host_thread_join(&own.control.thread);
        own.running = false;
    }
    return true;
}
