/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Where the agent of a middleware is: a UDP address, or a terminal such as /dev/ttyUSB0.
 *
 * Linux only, as real time is.  For one thread.  Nothing waits.
 */
#ifndef EPG_HOST_LINK_H
#define EPG_HOST_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/stream.h"

enum { EPG_HOST_LINK_OUTPUT = 16384 };

typedef struct epg_host_link {
    epg_stream_t stream;
    int file;           /**< -1: not open */
    const char *device; /**< of a terminal, which is opened again when it is there again; NULL: UDP */
    uint32_t baud_rate;
    uint64_t retry_ns;                          /**< when opening is tried next, by the monotonic clock */
    unsigned char output[EPG_HOST_LINK_OUTPUT]; /**< for a terminal: what it has not taken yet */
    size_t waiting;                             /**< bytes there */
} epg_host_link_t;

/** Whether `text` is HOST:PORT. */
bool epg_host_link_is_address(const char *text);

/** To `address`, HOST:PORT; false, with a message, if there is no such host. */
bool epg_host_link_udp(epg_host_link_t *link, const char *address);

/** To the terminal `device`, as soon as it is there. */
void epg_host_link_serial(epg_host_link_t *link, const char *device, uint32_t baud_rate);

/** To `agent`, HOST:PORT or a terminal; false, with a message, if there is no such host. */
bool epg_host_link_open(epg_host_link_t *link, const char *agent, uint32_t baud_rate);

void epg_host_link_close(epg_host_link_t *link);

#endif
