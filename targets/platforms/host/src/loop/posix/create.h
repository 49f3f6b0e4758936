/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the control threads of Linux and macOS share.
 */
#ifndef EPG_HOST_CREATE_H
#define EPG_HOST_CREATE_H

#include "loop/thread.h"

enum { EPG_HOST_THREAD_INHERITS = -1 /**< the policy and priority of the caller */ };

/** Starts the thread, whose body is set, under `policy` and `priority`; returns 0 or the error number. */
int epg_host_thread_create(epg_host_thread_t *self, int policy, int priority);

/** Writes to the part of the stack that the cycle will use.  The system maps its pages now, and not during a cycle. */
void epg_host_thread_prefault(void);

#endif
