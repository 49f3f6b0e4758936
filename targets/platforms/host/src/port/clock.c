/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer's time: the time of the monotonic clock, or simulated time.  The number of a start is a constant in
 * simulated time.
 */
#include "clock.h"

#include <stdbool.h>

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

void epg_port_wait_until(uint64_t time_ns)
{
    while (!simulated && epg_host_monotonic_ns() < time_ns) {
        epg_host_sleep_until(time_ns);
    }
}

uint32_t epg_port_boot_id(void)
{
    static uint32_t number;
    if (simulated) {
        return 1U;
    }
    if (number == 0U) {
        number = epg_host_random();
    }
    if (number == 0U) {
        number = (uint32_t)epg_host_monotonic_ns() | 1U;
    }
    return number;
}
