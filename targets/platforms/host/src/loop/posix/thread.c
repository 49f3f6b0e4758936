/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Threads of POSIX.
 */
#define _POSIX_C_SOURCE 200809L

#include <pthread.h>
#include <signal.h>
#include <string.h>

#include "loop/posix/create.h"

enum {
    STACK_SIZE = 2 << 20,        /* bytes, with thread-local storage, up to 1 MiB with sanitizers */
    STACK_PREFAULTED = 256 << 10 /* bytes that the cycle may use without a page fault */
};

void epg_host_thread_prefault(void)
{
    volatile unsigned char stack[STACK_PREFAULTED];
    for (size_t i = 0; i < sizeof stack; i += 1024) {
        stack[i] = 0;
    }
}

static void *thread_main(void *argument)
{
    epg_host_thread_t *self = argument;
    self->body(self->argument);
    return NULL;
}

/** Starts the thread with `attributes`; returns 0 or the error number. */
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

int epg_host_thread_create(epg_host_thread_t *self, int policy, int priority)
{
    const struct sched_param parameter = {.sched_priority = priority};
    pthread_attr_t attributes;
    int error = pthread_attr_init(&attributes);
    if (error != 0) {
        return error;
    }
    pthread_attr_setstacksize(&attributes, STACK_SIZE);
    if (policy != EPG_HOST_THREAD_INHERITS) {
        pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
        pthread_attr_setschedpolicy(&attributes, policy);
        pthread_attr_setschedparam(&attributes, &parameter);
    }
    error = create(self, &attributes);
    pthread_attr_destroy(&attributes);
    return error;
}

const char *epg_host_thread_start(epg_host_thread_t *self, epg_host_thread_body_t body, void *argument)
{
    self->body = body;
    self->argument = argument;
    const int error = epg_host_thread_create(self, EPG_HOST_THREAD_INHERITS, 0);
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
