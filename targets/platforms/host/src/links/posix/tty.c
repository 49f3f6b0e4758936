/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A link by a terminal: a serial port, or a pseudo-terminal that another program has made.
 */
#define _DEFAULT_SOURCE /* for baud rates above those of POSIX */

#include "links/link.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "port/clock.h"
#include "speed.h"

static const uint64_t RETRY_NS = 200000000; /* from one attempt to open a terminal to the next */

/** Makes the terminal transfer plain bytes, at this baud rate. */
static bool make_raw(int file, uint32_t baud_rate)
{
    struct termios settings;
    if (tcgetattr(file, &settings) != 0) {
        return false;
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~(tcflag_t)CRTSCTS;
    return epg_host_speed_set(file, &settings, baud_rate) && tcflush(file, TCIFLUSH) == 0;
}

static void drop(epg_host_link_t *link)
{
    if (link->file >= 0) {
        close(link->file);
    }
    link->file = -1;
    link->waiting = 0;
    link->retry_ns = epg_host_monotonic_ns() + RETRY_NS;
}

static void open_device(epg_host_link_t *link)
{
    link->file = open(link->device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (link->file < 0 || !make_raw(link->file, link->baud_rate)) {
        drop(link);
    }
}

/** Writes as many of the waiting bytes as the terminal takes now. */
static void put_out(epg_host_link_t *link)
{
    if (link->file < 0 || link->waiting == 0) {
        return;
    }
    const ssize_t count = write(link->file, link->output, link->waiting);
    if (count > 0) {
        link->waiting -= (size_t)count;
        memmove(link->output, link->output + count, link->waiting);
    } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
        drop(link);
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
    struct pollfd entry = {.fd = link->file, .events = POLLHUP}; /* macOS looks at what is asked for */
    if (poll(&entry, 1, 0) > 0 && (entry.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) {
        drop(link); /* it was unplugged */
    }
    put_out(link);
    return link->file >= 0;
}

static size_t read_bytes(void *context, void *data, size_t size)
{
    epg_host_link_t *link = context;
    if (link->file < 0) {
        return 0;
    }
    const ssize_t count = read(link->file, data, size);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) {
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
    if (link->file >= 0) {
        close(link->file);
    }
    link->file = -1;
}
