/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A transport: the carrier of a middleware's bytes, such as a USB serial port, a UART or UDP.
 *
 * It consists of a stream for the middleware (epg/stream.h), and of functions that the platform calls to serve it.  All
 * of them belong to the communication side, and none of them waits.
 */
#ifndef EPG_TRANSPORT_H
#define EPG_TRANSPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/stream.h"

typedef struct epg_transport {
    /**
     * Starts the transport.  Returns false if that is impossible.  `title` names the purpose of the stream for the user
     * at the other end ("EPG console"); it stays valid.  Called before the control loop starts, and again after a
     * target was stopped or another transport did not start.  A transport that has started stays open meanwhile.
     */
    bool (*start)(void *context, const char *title);
    void (*poll)(void *context);  /**< called at least once per millisecond, before the middleware; may be NULL */
    void (*flush)(void *context); /**< called after the middleware: sends the bytes that it has written; may be NULL */
    /**
     * Returns the number of received bytes that were lost, because they were damaged or because they were not read in
     * time.  NULL: bytes cannot be lost.
     */
    uint32_t (*lost)(const void *context);
    epg_stream_t stream; /**< its `context` is the argument of all these functions */
} epg_transport_t;

#endif
