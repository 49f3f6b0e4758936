/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The store of boards that have no flash partition for it: it is always empty, and a write fails.
 */
#include "epg/port.h"

size_t epg_port_store_read(void *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

const char *epg_port_store_write(const void *data, size_t size)
{
    (void)data;
    (void)size;
    return "this target cannot store parameters";
}
