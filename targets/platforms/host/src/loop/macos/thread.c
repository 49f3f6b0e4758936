/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control thread of macOS.  No Mac has run this.
 */
#include <mach/mach.h>
#include <pthread.h>

#include "loop/posix/create.h"
#include "port/macos/ticks.h"

enum { SHORTEST_NS = 50 * 1000, LONGEST_NS = 50 * 1000 * 1000 }; /* computations that the kernel accepts */

bool epg_host_thread_prepare(void)
{
    epg_host_thread_prefault();
    return false; /* macOS locks single pages only */
}

/** Asks the kernel for half of each period.  The user needs no permission for that. */
static bool constrain(const epg_host_thread_t *self, uint64_t period_ns)
{
    const uint64_t half_ns = period_ns / 2;
    const uint64_t computation_ns = half_ns < SHORTEST_NS ? SHORTEST_NS : half_ns > LONGEST_NS ? LONGEST_NS : half_ns;
    const uint32_t computation = (uint32_t)epg_host_ticks(computation_ns);
    thread_time_constraint_policy_data_t policy = {
        .period = 2 * computation, .computation = computation, .constraint = 2 * computation, .preemptible = TRUE};
    return thread_policy_set(pthread_mach_thread_np((pthread_t)self->handle), THREAD_TIME_CONSTRAINT_POLICY,
                             (thread_policy_t)&policy, THREAD_TIME_CONSTRAINT_POLICY_COUNT) == KERN_SUCCESS;
}

const char *epg_host_thread_start_control(epg_host_thread_t *self, epg_host_thread_body_t body, epg_host_run_t *run,
                                          void *argument)
{
    run->scheduler = "TIME_CONSTRAINT";
    run->scheduler_reason = NULL;
    const char *error = epg_host_thread_start(self, body, argument);
    if (error == NULL && !constrain(self, run->host->target->application->period_ns)) {
        run->scheduler = "TIMESHARE";
    }
    return error;
}
