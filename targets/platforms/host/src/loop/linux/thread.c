/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Threads of Linux.
 */
#define _POSIX_C_SOURCE 200809L

#include "loop/thread.h"

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

enum {
    PRIORITY = 80,               /* above threaded interrupts (50), below the kernel's own threads (99) */
    STACK_SIZE = 2 << 20,        /* bytes, with thread-local storage, up to 1 MiB with sanitizers */
    STACK_PREFAULTED = 256 << 10 /* bytes that the cycle may use without a page fault */
};

/** Writes to the part of the stack that the cycle will use.  The system maps its pages now, and not during a cycle. */
static void prefault_stack(void)
{
    volatile unsigned char stack[STACK_PREFAULTED];
    for (size_t i = 0; i < sizeof stack; i += 1024) {
        stack[i] = 0;
    }
}

bool epg_host_thread_prepare(void)
{
    /*
     * Without a real-time policy, the kernel may delay a timer by up to 50 us, to handle several at once.  Forbid it.
     */
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    prefault_stack();
    /* The loop uses only memory that is mapped already.  MCL_FUTURE could make later allocations of other code fail. */
    return mlockall(MCL_CURRENT) == 0;
}

static void *thread_main(void *argument)
{
    epg_host_thread_t *self = argument;
    self->body(self->argument);
    return NULL;
}

/** Starts the thread with `attributes`, which may be NULL; returns 0 or the error number. */
static int create(epg_host_thread_t *self, const pthread_attr_t *attributes)
{
    pthread_t thread;
    sigset_t all;
    sigset_t before;
    /* The new thread inherits this mask.  Threads of the program handle all signals, so that none interrupts a cycle. */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = pthread_create(&thread, attributes, thread_main, self);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    self->handle = (uintptr_t)thread;
    return error;
}

/** Starts the thread under `policy` and `priority`; returns 0 or the error number. */
static int create_with_policy(epg_host_thread_t *self, int policy, int priority)
{
    const struct sched_param parameter = {.sched_priority = priority};
    pthread_attr_t attributes;
    int error = pthread_attr_init(&attributes);
    if (error != 0) {
        return error;
    }
    pthread_attr_setstacksize(&attributes, STACK_SIZE);
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, policy);
    pthread_attr_setschedparam(&attributes, &parameter);
    error = create(self, &attributes);
    pthread_attr_destroy(&attributes);
    return error;
}

const char *epg_host_thread_start(epg_host_thread_t *self, epg_host_thread_body_t body, void *argument)
{
    self->body = body;
    self->argument = argument;
    const int error = create(self, NULL);
    return error == 0 ? NULL : strerror(error);
}

/** Tries SCHED_FIFO with the highest priority that the user is permitted, at most PRIORITY; else uses SCHED_OTHER. */
const char *epg_host_thread_start_control(epg_host_thread_t *self, epg_host_thread_body_t body, epg_host_run_t *run,
                                          void *argument)
{
    self->body = body;
    self->argument = argument;
    run->scheduler = "SCHED_FIFO";
    run->scheduler_reason = NULL;
    int error = create_with_policy(self, SCHED_FIFO, PRIORITY);
    struct rlimit limit;
    if (error == EPERM && getrlimit(RLIMIT_RTPRIO, &limit) == 0 && limit.rlim_cur > 0 && limit.rlim_cur < PRIORITY) {
        error = create_with_policy(self, SCHED_FIFO, (int)limit.rlim_cur);
    }
    if (error != 0) {
        run->scheduler = "SCHED_OTHER";
        run->scheduler_reason = strerror(error);
        error = create_with_policy(self, SCHED_OTHER, 0);
    }
    return error == 0 ? NULL : strerror(error);
}

bool epg_host_thread_is_caller(const epg_host_thread_t *self)
{
    return pthread_equal(pthread_self(), (pthread_t)self->handle) != 0;
}

void epg_host_thread_join(epg_host_thread_t *self)
{
    pthread_join((pthread_t)self->handle, NULL);
}
