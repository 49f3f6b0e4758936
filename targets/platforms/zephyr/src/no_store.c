/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Boards without a partition to store in.
 */
#include "epg/port.h"

size_t epg_port_store_read(void *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

bool epg_port_store_write(const void *data, size_t size)
{
    (void)data;
    (void)size;
    return false;
}
