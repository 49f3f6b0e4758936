/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The wait of a middleware for bytes.  The communication side has its own thread, so it can sleep for a short time.
 */
#include "epg/port_wait.h"

#include "clock.h"

void epg_port_wait_for_bytes(void)
{
    epg_host_sleep_until(epg_host_monotonic_ns() + 100000U); /* 0.1 ms */
}
