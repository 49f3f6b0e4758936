/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Clock, sleep and random numbers of Windows.
 */
#define _CRT_RAND_S /* rand_s() */

#include <stdlib.h>

#include <windows.h>

#include <timeapi.h>

#include "port/clock.h"
#include "port/windows/timer.h"

#if !defined(CREATE_WAITABLE_TIMER_HIGH_RESOLUTION) /* headers of mingw-w64 10 do not have it */
#define CREATE_WAITABLE_TIMER_HIGH_RESOLUTION 0x00000002
#endif

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

/**
 * A timer whose resolution is about 0.5 ms.  Before version 1803, Windows has no such timers: then the whole computer's
 * clock ticks every millisecond, until the program ends.
 */
static HANDLE make_timer(void)
{
    HANDLE timer = CreateWaitableTimerExW(NULL, NULL, CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, TIMER_ALL_ACCESS);
    if (timer == NULL) {
        timeBeginPeriod(1);
        timer = CreateWaitableTimerExW(NULL, NULL, 0, TIMER_ALL_ACCESS);
    }
    return timer;
}

void *epg_host_timer(uint64_t time_ns)
{
    static _Thread_local HANDLE timer;
    if (timer == NULL) {
        timer = make_timer();
    }
    const uint64_t now_ns = epg_host_monotonic_ns();
    const uint64_t units = time_ns > now_ns ? (time_ns - now_ns + 99U) / 100U : 0U;
    const LARGE_INTEGER due = {.QuadPart = -(LONGLONG)units}; /* negative: from now on, in units of 100 ns */
    return timer != NULL && SetWaitableTimer(timer, &due, 0, NULL, NULL, FALSE) ? timer : NULL;
}

void epg_host_sleep_until(uint64_t time_ns)
{
    HANDLE timer = epg_host_timer(time_ns);
    if (timer == NULL || WaitForSingleObject(timer, INFINITE) != WAIT_OBJECT_0) {
        Sleep(1);
    }
}

uint32_t epg_host_random(void)
{
    unsigned int number;
    return rand_s(&number) == 0 ? number : 0U;
}
