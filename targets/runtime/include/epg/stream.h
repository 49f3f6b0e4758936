/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A stream of bytes in both directions, such as a USB serial port: what a transport gives to a middleware.
 *
 * All functions belong to the communication side and return at once.
 */
#ifndef EPG_STREAM_H
#define EPG_STREAM_H

#include <stdbool.h>
#include <stddef.h>

typedef struct epg_stream {
    /** Whether somebody is at the other end, as far as the transport can know (USB: DTR). */
    bool (*connected)(void *context);
    /** Copies up to `size` bytes that have arrived to `data`; returns how many, 0 if there are none. */
    size_t (*read)(void *context, void *data, size_t size);
    /** Takes up to `size` bytes; returns how many, 0 if there is no room. */
    size_t (*write)(void *context, const void *data, size_t size);
    /** How many bytes write() would take now. */
    size_t (*writable)(void *context);
    void *context;
    bool datagrams; /**< one write() is one packet, and one read() gives one, whole if `size` is large enough (UDP) */
} epg_stream_t;

#endif
