/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * EPG's stream as a custom transport of libmicroros.
 *
 * libmicroros reads bytes with a timeout.  A stream never waits, so this transport waits until the timeout is over.
 */
#include "micro_ros_transport.h"

#include <rmw_microros/rmw_microros.h>

#include "epg/port.h"
#include "epg/port_wait.h"

#define MS ((uint64_t)1000000)

enum { DROPPED = 64 }; /* largest number of readings in one call of epg_micro_ros_transport_drop() */

static const epg_stream_t *stream;
static bool heard;

static bool open_or_close(struct uxrCustomTransport *transport)
{
    (void)transport;
    return true; /* the platform has opened the stream */
}

static size_t write_bytes(struct uxrCustomTransport *transport, const uint8_t *data, size_t size, uint8_t *error)
{
    (void)transport;
    *error = 0;
    if (!stream->connected(stream->context) || (stream->datagrams && stream->writable(stream->context) < size)) {
        *error = 1;
        return 0;
    }
    return stream->write(stream->context, data, size);
}

static size_t read_bytes(struct uxrCustomTransport *transport, uint8_t *data, size_t size, int timeout_ms,
                         uint8_t *error)
{
    (void)transport;
    const uint64_t until_ns = epg_port_time_ns() + (timeout_ms > 0 ? (uint64_t)timeout_ms * MS : 0U);
    *error = 0;
    for (;;) {
        const size_t count = stream->read(stream->context, data, size);
        heard = heard || count > 0;
        if (count > 0 || epg_port_time_ns() >= until_ns) {
            return count;
        }
        epg_port_wait_for_bytes();
    }
}

void epg_micro_ros_transport_drop(void)
{
    char dropped[64];
    for (int i = 0; i < DROPPED && stream->read(stream->context, dropped, sizeof dropped) > 0; i++) {
    }
}

bool epg_micro_ros_transport_heard(void)
{
    const bool was = heard;
    heard = false;
    return was;
}

bool epg_micro_ros_transport_start(const epg_stream_t *our_stream)
{
    stream = our_stream;
    heard = false;
    return rmw_uros_set_custom_transport(!our_stream->datagrams, NULL, open_or_close, open_or_close, write_bytes,
                                         read_bytes) == RMW_RET_OK;
}
