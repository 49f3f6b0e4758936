/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The clock that the client library asks for, in place of its own, which needs an operating system.
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
