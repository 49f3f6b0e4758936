/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sleep of macOS.  No Mac has run this.
 */
#include <mach/mach_time.h>

#include "port/clock.h"
#include "port/macos/ticks.h"

uint64_t epg_host_ticks(uint64_t ns)
{
    mach_timebase_info_data_t tick; /* numer / denom nanoseconds */
    (void)mach_timebase_info(&tick);
    return ns / tick.numer * tick.denom + ns % tick.numer * tick.denom / tick.numer;
}

void epg_host_sleep_until(uint64_t time_ns)
{
    (void)mach_wait_until(epg_host_ticks(time_ns));
}
