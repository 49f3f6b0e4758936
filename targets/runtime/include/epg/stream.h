/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A stream of bytes in both directions, such as a USB serial port or a UART.
 *
 * A transport (epg/transport.h) offers a stream, and a middleware (epg/middleware.h) uses it.  So a middleware does not
 * depend on the hardware.  All functions belong to the communication side and return at once; each is called with
 * `context` as its first argument.
 */
#ifndef EPG_STREAM_H
#define EPG_STREAM_H

#include <stdbool.h>
#include <stddef.h>

typedef struct epg_stream {
    /**
     * Returns true if a program at the other end reads the output, as far as the transport can know (USB: the signal
     * DTR).  It says nothing about the input: many programs send without DTR, and a stop can be their last line.
     */
    bool (*connected)(void *context);
    /**
     * Copies up to `size` bytes that have arrived to `data`.  Returns their number, 0 if there are none.  It reads
     * whether or not `connected` returns true, and a change of `connected` drops no bytes that have arrived.
     */
    size_t (*read)(void *context, void *data, size_t size);
    /** Accepts up to `size` bytes for sending.  Returns their number, 0 if there is no room. */
    size_t (*write)(void *context, const void *data, size_t size);
    /** Returns the number of bytes that write() would accept now. */
    size_t (*writable)(void *context);
    /**
     * For a stream that searches what it receives for stops itself, because several programs send to it.  Returns true
     * if a stop has arrived after the bytes that read() returned last.  NULL: the reader must search.
     */
    bool (*overtaken)(void *context);
    void *context;
    bool datagrams; /**< UDP: one write() sends one packet; one read() gives one packet, cut to `size` if longer */
} epg_stream_t;

#endif
