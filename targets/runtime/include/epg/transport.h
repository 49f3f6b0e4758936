/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A transport: a stream of bytes with what a platform has to do for it, such as a USB serial port or a UART.
 *
 * A platform calls it on the communication side.  None of the functions waits.
 */
#ifndef EPG_TRANSPORT_H
#define EPG_TRANSPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/stream.h"

typedef struct epg_transport {
    /**
     * Before the control loop starts; false when that is impossible.  `title` says what the stream is for, to people
     * who see it from the other side ("EPG console"), and stays valid.  Called again after a target was stopped.
     */
    bool (*start)(void *context, const char *title);
    void (*poll)(void *context);  /**< at least once per millisecond, before the middleware; or NULL */
    void (*flush)(void *context); /**< after the middleware: what it has written goes out; or NULL */
    /** Bytes that came and were lost because nobody took them, or because they were damaged; or NULL: none can be. */
    uint32_t (*lost)(const void *context);
    epg_stream_t stream; /**< its `context` is that of all these functions */
} epg_transport_t;

#endif
