/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sleep of Linux.
 */
#define _POSIX_C_SOURCE 200809L

#include <time.h>

#include "port/clock.h"

void epg_host_sleep_until(uint64_t time_ns)
{
    const struct timespec until = {.tv_sec = (time_t)(time_ns / 1000000000U), .tv_nsec = (long)(time_ns % 1000000000U)};
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}
