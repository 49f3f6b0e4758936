/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer's time: the time of the monotonic clock, or simulated time.  The number of a start is a constant in
 * simulated time.
 */
#if !defined(_WIN32)
#define _POSIX_C_SOURCE 200809L
#endif

#include "clock.h"

#include <errno.h>
#include <stdbool.h>
#include <time.h>

#if defined(__linux__)
#include <sys/random.h>
#endif

#include "epg/port.h"

static bool simulated;
static uint64_t simulated_ns;

void epg_host_clock_simulate(uint64_t time_ns)
{
    simulated = true;
    simulated_ns = time_ns;
}

void epg_host_clock_real(void)
{
    simulated = false;
}

uint64_t epg_port_time_ns(void)
{
    return simulated ? simulated_ns : epg_host_monotonic_ns();
}

#if defined(__linux__)

void epg_port_wait_until(uint64_t time_ns)
{
    const struct timespec until = {.tv_sec = (time_t)(time_ns / 1000000000U), .tv_nsec = (long)(time_ns % 1000000000U)};
    while (!simulated && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR) {
    }
}

uint32_t epg_port_boot_id(void)
{
    static uint32_t number;
    if (simulated) {
        return 1U;
    }
    if (number == 0U && (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number || number == 0U)) {
        number = (uint32_t)epg_host_monotonic_ns() | 1U; /* a kernel without random numbers */
    }
    return number;
}

#else /* not Linux: only simulated time, in which nothing waits */

void epg_port_wait_until(uint64_t time_ns)
{
    (void)time_ns;
}

uint32_t epg_port_boot_id(void)
{
    return 1U;
}

#endif
