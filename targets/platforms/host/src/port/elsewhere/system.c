/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Programs in which all time is simulated, so that nothing waits.
 */
#include "port/clock.h"

void epg_host_sleep_until(uint64_t time_ns)
{
    while (epg_host_monotonic_ns() < time_ns) {
    }
}

uint32_t epg_host_random(void)
{
    return 1U;
}
