/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * One run of a target: what both ways of running it share.
 */
#ifndef EPG_HOST_RUN_H
#define EPG_HOST_RUN_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "communication.h"
#include "epg/host.h"
#include "epg/plant.h"
#include "services.h"
#include "timing.h"
#include "trace.h"

typedef struct epg_host_run {
    const epg_host_target_t *host;
    uint64_t end_ns; /**< no cycle starts at or after this time; UINT64_MAX: until stopped */
    epg_plant_run_t plant;
    epg_host_communication_t communication;
    epg_host_services_t services; /**< real time only */
    bool ends_with_input;         /**< the run ends when standard input does */
    epg_host_trace_t trace;
    epg_host_timing_t timing;
    uint64_t ran_ns;        /**< how far the run came */
    uint64_t missed_at_end; /**< ticks missed that no later cycle could count */
    uint64_t wall_time_ns;
    const epg_host_signal_t *diverged; /**< the plant's output that ended the run; NULL: none */
    double diverged_value;
    uint64_t diverged_ns;         /**< when */
    const char *scheduler;        /**< "simulated", "SCHED_FIFO" or "SCHED_OTHER" */
    const char *scheduler_reason; /**< why it is not SCHED_FIFO; NULL otherwise */
    bool memory_locked;
} epg_host_run_t;

/** Set by the user's interrupt (Ctrl-C); both loops end after the cycle at hand. */
extern volatile sig_atomic_t epg_host_interrupted;

/**
 * Tick after the one at `tick_ns`, when the cycle has ended at `now_ns`: the newest one that is due, at least the
 * next.  The phase never moves; ticks in between are counted in `*missed`.
 */
static inline uint64_t epg_host_next_tick(uint64_t tick_ns, uint64_t period_ns, uint64_t now_ns, uint32_t *missed)
{
    const uint64_t next_ns = tick_ns + period_ns;
    const uint64_t skipped = now_ns > next_ns ? (now_ns - next_ns) / period_ns : 0;
    *missed = (uint32_t)skipped;
    return next_ns + skipped * period_ns;
}

/** Starts the plant, then the application, both at time 0.  `application` is the target's own or a copy of it. */
void epg_host_run_start(epg_host_run_t *run, const epg_application_t *application);

/** A plant whose output is farther from 0 than this has diverged, whatever its unit. */
#define EPG_HOST_PLANT_LARGEST 1e12

/**
 * False when an output of the plant is not finite or too large: it must not reach a sensor, and the run must end.
 * `time_ns` is the time since time 0.
 */
bool epg_host_plant_is_sound(epg_host_run_t *run, uint64_t time_ns);

/**
 * After the last cycle, that of `tick_ns`, when the next would have been that of `next_ns`: counts the ticks lost up
 * to the end, makes the outputs safe, and says so if the plant has ended the run.
 */
void epg_host_run_end(epg_host_run_t *run, uint64_t tick_ns, uint64_t next_ns);

/**
 * Puts the simulated clock to 0 and returns the application to start: the target's, except that its cycle takes
 * simulated time when a `$stall` event says so.
 */
const epg_application_t *epg_host_prepare_simulated(epg_host_run_t *run);

/** Runs from time 0 to the end in simulated time. */
void epg_host_run_simulated(epg_host_run_t *run);

/** Runs from time 0 to the end in real time; false, with a message, if this is not possible. */
bool epg_host_run_realtime(epg_host_run_t *run);

#endif
