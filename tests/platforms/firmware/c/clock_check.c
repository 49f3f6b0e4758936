/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * src/clock.c of docs/any-firmware.md with a counter that runs at any speed, and with interrupts that read the time, too,
 * before and after the counter is read.  Each time must be between the true times before and after its call.
 */
#include "board.h"
#include "turntable_firmware.h"

#include <stdio.h>
#include <stdlib.h>

static uint64_t now;
static unsigned int depth;
static uint32_t seed = 1;

static uint32_t any(void)
{
    seed = seed * 1664525U + 1013904223U;
    return seed >> 8;
}

static void check(void)
{
    const uint64_t before = now;
    const uint64_t time_ns = turntable_time_ns();
    if (time_ns < before * 1000U || time_ns > now * 1000U) {
        printf("%llu ns, not %llu ... %llu us\n", (unsigned long long)time_ns, (unsigned long long)before,
               (unsigned long long)now);
        exit(1);
    }
}

static void pass(void)
{
    now += (any() % 2U ? any() % 3U : any() * 6U); /* at most 2^27: four levels stay below half a turn of the counter */
    if (depth < 3U && any() % 3U == 0) {
        depth++;
        check();
        depth--;
    }
}

uint32_t board_microseconds(void)
{
    pass();
    const uint32_t counter = (uint32_t)now;
    pass();
    return counter;
}

int main(void)
{
    for (unsigned int i = 0; i < 1000000U; i++) {
        check();
    }
    printf("%llu turns\n", (unsigned long long)(now >> 32));
    return 0;
}
