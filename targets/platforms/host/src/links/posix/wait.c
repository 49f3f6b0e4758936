/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The wait for bytes of the middlewares.
 */
#define _POSIX_C_SOURCE 200809L

#include <poll.h>

#include "links/services.h"
#include "port/clock.h"

enum { MS = 1000 * 1000, MOST_FILES = 3 };

void epg_host_services_wait(const epg_host_services_t *services, uint64_t time_ns)
{
    const uint64_t now_ns = epg_host_monotonic_ns();
    const int timeout_ms = time_ns > now_ns ? (int)((time_ns - now_ns + MS - 1) / MS) : 0;
    struct pollfd entries[MOST_FILES];
    nfds_t count = 0;
    if (services->link != NULL && services->link->file >= 0) {
        entries[count++] = (struct pollfd){.fd = services->link->file, .events = POLLIN};
    }
    if (services->terminal != NULL && epg_host_terminal_listens(services->terminal)) {
        entries[count++] = (struct pollfd){.fd = services->terminal->input, .events = POLLIN};
    }
    if (services->udp != NULL) {
        entries[count++] = (struct pollfd){.fd = epg_host_udp_console_file(services->udp), .events = POLLIN};
    }
    (void)poll(entries, count, timeout_ms);
}
