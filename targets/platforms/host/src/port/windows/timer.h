/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The timer with which threads of Windows wait.
 */
#ifndef EPG_HOST_TIMER_H
#define EPG_HOST_TIMER_H

#include <stdint.h>

/** The handle of the calling thread's timer, which is signalled at monotonic time `time_ns`; NULL if there is none. */
void *epg_host_timer(uint64_t time_ns);

#endif
