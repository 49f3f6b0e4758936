/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The number of a start: the same for all, so that runs are equal.
 */
#include "epg/port.h"

uint32_t epg_port_boot_id(void)
{
    return 1U;
}
