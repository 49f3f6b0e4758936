/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Threads, as the system has them.  They handle no signals.
 */
#ifndef EPG_HOST_THREAD_H
#define EPG_HOST_THREAD_H

#include <stdbool.h>
#include <stdint.h>

#include "run.h"

typedef void (*epg_host_thread_body_t)(void *argument);

/** A thread.  The object must exist until the thread has ended. */
typedef struct epg_host_thread {
    uintptr_t handle;
    epg_host_thread_body_t body;
    void *argument;
} epg_host_thread_t;

/** Starts a thread.  Returns NULL, or the reason why it cannot be started. */
const char *epg_host_thread_start(epg_host_thread_t *self, epg_host_thread_body_t body, void *argument);

/**
 * Starts a thread with the best priority that the user is permitted, which it notes in `run`.  Returns NULL, or the
 * reason why it cannot be started.
 */
const char *epg_host_thread_start_control(epg_host_thread_t *self, epg_host_thread_body_t body, epg_host_run_t *run,
                                          void *argument);

/** Prepares the calling thread for the control loop.  Returns true if it will have no page faults. */
bool epg_host_thread_prepare(void);

bool epg_host_thread_is_caller(const epg_host_thread_t *self);

/** Waits for the end of the thread. */
void epg_host_thread_join(epg_host_thread_t *self);

#endif
