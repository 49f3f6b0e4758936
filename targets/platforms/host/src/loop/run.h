/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A run of a target: the part that simulated time and real time share.  Time 0 is the first tick.
 */
#ifndef EPG_HOST_RUN_H
#define EPG_HOST_RUN_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "epg/host.h"
#include "epg/plant.h"
#include "files/communication.h"
#include "files/trace.h"
#include "links/services.h"
#include "timing.h"

typedef struct epg_host_run {
    const epg_host_target_t *host;
    uint64_t end_ns; /**< no cycle starts at or after this time; UINT64_MAX: the run ends when it is stopped */
    epg_plant_run_t plant;
    epg_host_communication_t communication;
    epg_host_services_t services; /**< used in real time only */
    bool ends_with_input;         /**< the run ends at the end of standard input */
    epg_host_trace_t trace;
    epg_host_timing_t timing;
    uint64_t ran_ns;                   /**< the time that the run has reached */
    uint64_t missed_at_end;            /**< ticks that were missed after the last cycle */
    uint64_t wall_time_ns;             /**< duration of the run by the monotonic clock */
    const epg_host_signal_t *diverged; /**< the output of the plant that ended the run; NULL: none */
    double diverged_value;
    uint64_t diverged_ns;         /**< time at which it diverged */
    double pace;                  /**< simulated time at this multiple of real time, with a connection; 0: no waiting */
    uint64_t pace_start_ns;       /**< monotonic time of simulated time 0 at this pace */
    uint64_t write_ns;            /**< monotonic time at which a run with `pace` writes its files the next time */
    const char *scheduler;        /**< "simulated", "SCHED_FIFO", "SCHED_OTHER" or "native_sim" */
    const char *scheduler_reason; /**< the error for which SCHED_FIFO was not used; NULL otherwise */
    bool memory_locked;           /**< the memory could be locked, so the control thread has no page faults */
} epg_host_run_t;

/** Set to 1 by Ctrl-C, SIGTERM or SIGHUP.  The loops then end after the present cycle. */
extern volatile sig_atomic_t epg_host_interrupted;

/**
 * Returns the time of the next tick after a cycle: the tick of the cycle was at `tick_ns`, and the cycle ended at
 * `now_ns`.  It is the newest tick that is due, or the one after `tick_ns` if none is due.  Ticks in between are
 * counted in `*missed`.  All ticks are multiples of `period_ns`, however long a cycle takes.
 */
static inline uint64_t epg_host_next_tick(uint64_t tick_ns, uint64_t period_ns, uint64_t now_ns, uint32_t *missed)
{
    const uint64_t next_ns = tick_ns + period_ns;
    const uint64_t skipped = now_ns > next_ns ? (now_ns - next_ns) / period_ns : 0;
    *missed = (uint32_t)skipped;
    return next_ns + skipped * period_ns;
}

/** Starts the plant, then the application, both at time 0.  `application` is the target's, or a copy of it. */
void epg_host_run_start(epg_host_run_t *run, const epg_application_t *application);

/**
 * Returns false if an output of the plant is not finite or too large at `time_ns`.  The output must not reach a sensor,
 * and the run must end.
 */
bool epg_host_plant_is_sound(epg_host_run_t *run, uint64_t time_ns);

/**
 * Ends a run after its last cycle, whose tick was at `tick_ns`; the next tick would have been at `next_ns`.  Counts the
 * ticks that were missed up to the end, makes the outputs safe, and prints a message if the plant has diverged.
 */
void epg_host_run_end(epg_host_run_t *run, uint64_t tick_ns, uint64_t next_ns);

/**
 * Sets the simulated clock to 0, and returns the application to start: a copy of the target's whose cycle takes
 * simulated time if there is a `$stall` event.
 */
const epg_application_t *epg_host_prepare_simulated(epg_host_run_t *run);

/**
 * Prepares a run with `pace` of a ROS 2 node: it gets the topic /clock.  Returns false, with a message, if memory is
 * short.
 */
bool epg_host_pace_prepare(epg_target_t *target);

/** Starts the middlewares of a run with `pace`, and reports that it is not repeatable. */
void epg_host_pace_start(epg_host_run_t *run);

/**
 * Serves the middlewares until it is the time for the tick at simulated time `tick_ns`, at least once.  A computer that
 * is too slow for the pace lets simulated time fall behind; the run does not catch up.
 */
void epg_host_pace_wait(epg_host_run_t *run, uint64_t tick_ns);

/** Stops the middlewares. */
void epg_host_pace_end(epg_host_run_t *run);

/** Runs from time 0 to the end in simulated time. */
void epg_host_run_simulated(epg_host_run_t *run);

/** Runs from time 0 to the end in real time.  Returns false, with a message, if this is not possible. */
bool epg_host_run_realtime(epg_host_run_t *run);

#endif
