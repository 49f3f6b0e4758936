/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control thread of Linux.
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <sched.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include "loop/posix/create.h"

enum { PRIORITY = 80 }; /* above threaded interrupts (50), below the kernel's own threads (99) */

bool epg_host_thread_prepare(void)
{
    /*
     * Without a real-time policy, the kernel may delay a timer by up to 50 us, to handle several at once.  Forbid it.
     */
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    epg_host_thread_prefault();
    /* The loop uses only memory that is mapped already.  MCL_FUTURE could make later allocations of other code fail. */
    return mlockall(MCL_CURRENT) == 0;
}

/** Tries SCHED_FIFO with the highest priority that the user is permitted, at most PRIORITY; else uses SCHED_OTHER. */
const char *epg_host_thread_start_control(epg_host_thread_t *self, epg_host_thread_body_t body, epg_host_run_t *run,
                                          void *argument)
{
    self->body = body;
    self->argument = argument;
    run->scheduler = "SCHED_FIFO";
    run->scheduler_reason = NULL;
    int error = epg_host_thread_create(self, SCHED_FIFO, PRIORITY);
    struct rlimit limit;
    if (error == EPERM && getrlimit(RLIMIT_RTPRIO, &limit) == 0 && limit.rlim_cur > 0 && limit.rlim_cur < PRIORITY) {
        error = epg_host_thread_create(self, SCHED_FIFO, (int)limit.rlim_cur);
    }
    if (error != 0) {
        run->scheduler = "SCHED_OTHER";
        run->scheduler_reason = strerror(error);
        error = epg_host_thread_create(self, SCHED_OTHER, 0);
    }
    return error == 0 ? NULL : strerror(error);
}
