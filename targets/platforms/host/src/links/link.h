/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The link to the agent of a middleware: by UDP, or by a terminal such as /dev/ttyUSB0 or COM3.
 *
 * Only one thread may use a link.  No function waits.
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
    const char *device; /**< path of the terminal, which is opened again after it was unplugged; NULL: UDP */
    uint32_t baud_rate;
    uint64_t retry_ns;                          /**< monotonic time of the next attempt to open the terminal */
    unsigned char output[EPG_HOST_LINK_OUTPUT]; /**< bytes that the terminal has not taken yet */
    size_t waiting;                             /**< number of these bytes */
} epg_host_link_t;

/** True if `text` has the form HOST:PORT. */
bool epg_host_link_is_address(const char *text);

/**
 * Makes a link by UDP to `address`, HOST:PORT.  Returns false, with a message, if the host is unknown or unreachable.
 */
bool epg_host_link_udp(epg_host_link_t *link, const char *address);

/**
 * Makes a link by the terminal `device`, which need not exist yet: it is opened as soon as it does.  Returns true.
 */
bool epg_host_link_serial(epg_host_link_t *link, const char *device, uint32_t baud_rate);

/**
 * Makes a link to `agent`, which is HOST:PORT or a terminal.  Returns false, with a message, like epg_host_link_udp().
 */
bool epg_host_link_open(epg_host_link_t *link, const char *agent, uint32_t baud_rate);

void epg_host_link_close(epg_host_link_t *link);

#endif
