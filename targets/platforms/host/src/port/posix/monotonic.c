/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The monotonic clock of POSIX.
 */
#define _POSIX_C_SOURCE 200809L

#include <time.h>

#include "port/clock.h"

uint64_t epg_host_monotonic_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec;
}
