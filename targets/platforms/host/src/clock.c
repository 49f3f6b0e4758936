/**
 * @file
 * The host's two clocks, and the port layer's time.
 */
#if !defined(_WIN32)
#define _POSIX_C_SOURCE 200809L
#endif

#include "clock.h"

#include <errno.h>
#include <stdbool.h>
#include <time.h>

#if defined(_WIN32)
#include <windows.h>
#endif

#include "epg/port.h"

static bool simulated;
static uint64_t simulated_ns;

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

#else /* there is no real time either */

void epg_port_wait_until(uint64_t time_ns)
{
    (void)time_ns;
}

#endif
