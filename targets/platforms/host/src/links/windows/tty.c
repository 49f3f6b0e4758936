/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A link by a serial port: Windows has none.
 */
#include <stdio.h>

#include "links/link.h"
#include "sockets.h"

bool epg_host_link_serial(epg_host_link_t *link, const char *device, uint32_t baud_rate)
{
    (void)link;
    (void)baud_rate;
    fprintf(stderr,
            "error: on Windows, an agent cannot be reached by the serial port %s\n"
            "hint: run the agent in WSL2 or on another computer, and give its address, HOST:PORT\n",
            device);
    return false;
}

void epg_host_link_close(epg_host_link_t *link)
{
    if (link->file >= 0) {
        epg_host_socket_close(link->file);
    }
    link->file = -1;
}
