/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The monotonic clock of POSIX.
 */
#define _POSIX_C_SOURCE 200809L

#include <time.h>

#include "port/clock.h"

/* On macOS, the clock by which threads wait.  CLOCK_MONOTONIC has only microseconds there. */
#if defined(CLOCK_UPTIME_RAW)
static const clockid_t clock_id = CLOCK_UPTIME_RAW;
#else
static const clockid_t clock_id = CLOCK_MONOTONIC;
#endif

uint64_t epg_host_monotonic_ns(void)
{
    struct timespec now;
    clock_gettime(clock_id, &now);
    return (uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec;
}
