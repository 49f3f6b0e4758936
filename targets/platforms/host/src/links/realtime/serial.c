/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A link by a serial port.
 */
#define _POSIX_C_SOURCE 200809L

#include "links/link.h"

#include <string.h>

#include "links/tty.h"
#include "port/clock.h"
#include "sockets.h"

static const uint64_t RETRY_NS = 200000000; /* from one attempt to open a port to the next */

static void drop(epg_host_link_t *link)
{
    epg_host_link_close(link);
    link->waiting = 0;
    link->retry_ns = epg_host_monotonic_ns() + RETRY_NS;
}

static void open_device(epg_host_link_t *link)
{
    link->file = epg_host_tty_open(link->device, link->baud_rate);
    if (link->file < 0) {
        drop(link);
    }
}

/** Writes as many of the waiting bytes as the port takes now. */
static void put_out(epg_host_link_t *link)
{
    if (link->file < 0 || link->waiting == 0) {
        return;
    }
    const long count = epg_host_tty_write(link->file, link->output, link->waiting);
    if (count < 0) {
        drop(link);
    } else if (count > 0) {
        link->waiting -= (size_t)count;
        memmove(link->output, link->output + count, link->waiting);
    }
}

static bool connected(void *context)
{
    epg_host_link_t *link = context;
    if (link->file < 0) {
        if (epg_host_monotonic_ns() < link->retry_ns) {
            return false;
        }
        open_device(link);
        return link->file >= 0;
    }
    if (!epg_host_tty_is_there(link->file)) {
        drop(link);
    }
    put_out(link);
    return link->file >= 0;
}

static size_t read_bytes(void *context, void *data, size_t size)
{
    epg_host_link_t *link = context;
    const long count = link->file >= 0 ? epg_host_tty_read(link->file, data, size) : 0;
    if (count < 0) {
        drop(link);
    }
    return count > 0 ? (size_t)count : 0;
}

static size_t writable(void *context)
{
    epg_host_link_t *link = context;
    put_out(link);
    return link->file >= 0 ? sizeof link->output - link->waiting : 0;
}

static size_t write_bytes(void *context, const void *data, size_t size)
{
    epg_host_link_t *link = context;
    const size_t room = link->file >= 0 ? sizeof link->output - link->waiting : 0;
    const size_t count = size < room ? size : room;
    memcpy(link->output + link->waiting, data, count);
    link->waiting += count;
    put_out(link);
    return count;
}

bool epg_host_link_serial(epg_host_link_t *link, const char *device, uint32_t baud_rate)
{
    *link = (epg_host_link_t){
        .stream =
            {.connected = connected, .read = read_bytes, .write = write_bytes, .writable = writable, .context = link},
        .file = -1,
        .device = device,
        .baud_rate = baud_rate,
    };
    return true;
}

void epg_host_link_close(epg_host_link_t *link)
{
    if (link->file >= 0 && link->device != NULL) {
        epg_host_tty_close(link->file);
    } else if (link->file >= 0) {
        epg_host_socket_close(link->file);
    }
    link->file = -1;
}
