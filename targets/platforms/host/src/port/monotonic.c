/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The monotonic clock.
 */
#if !defined(_WIN32)
#define _POSIX_C_SOURCE 200809L
#endif

#include "clock.h"

#if defined(_WIN32)
#include <windows.h>
#else
#include <time.h>
#endif

#if defined(_WIN32)

uint64_t epg_host_monotonic_ns(void)
{
    LARGE_INTEGER frequency;
    LARGE_INTEGER count;
    QueryPerformanceFrequency(&frequency);
    QueryPerformanceCounter(&count);
    /* Whole seconds and the rest apart: count * 10^9 would overflow within minutes. */
    const uint64_t ticks = (uint64_t)count.QuadPart;
    const uint64_t per_second = (uint64_t)frequency.QuadPart;
    return ticks / per_second * 1000000000U + ticks % per_second * 1000000000U / per_second;
}

#else

uint64_t epg_host_monotonic_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec;
}

#endif
