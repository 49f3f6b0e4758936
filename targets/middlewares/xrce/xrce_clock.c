/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The clock of the client library.  It replaces the library's clock, which needs an operating system.
 */
#include <uxr/client/util/time.h>

#include "epg/port.h"

int64_t uxr_nanos(void)
{
    return (int64_t)epg_port_time_ns();
}

int64_t uxr_millis(void)
{
    return uxr_nanos() / 1000000;
}
