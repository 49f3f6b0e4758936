/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A middleware: the way by which setpoints reach a target and its values leave it.
 *
 * Each folder `targets/middlewares/<name>` holds one middleware.  It is written once and uses no SDK.  The platform
 * gives it a stream of bytes (epg/stream.h), unless it opens a socket itself, and calls its functions.
 *
 * A middleware runs on the communication side.  It may compute for long, but it must not wait for the other end
 * (epg/port_wait.h names the exception).  It must also recover from a broken connection without help.
 */
#ifndef EPG_MIDDLEWARE_H
#define EPG_MIDDLEWARE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/stream.h"
#include "epg/target.h"

typedef struct epg_middleware {
    /** Runs once, before the first poll().  `stream` stays valid; it is NULL for a middleware that needs none. */
    void (*start)(const epg_target_t *target, const epg_stream_t *stream);
    /**
     * Delivers the setpoints that have arrived, sends the values that are due at `now_ns` (board time), and returns.
     * Called at least once per millisecond.
     */
    void (*poll)(uint64_t now_ns);
    /** Runs when the program ends.  Closes the connection, without waiting for the other end.  May be NULL. */
    void (*stop)(void);
    /**
     * Sleeps until data have arrived, until `until_ns` (board time) at the latest.  For a middleware that has opened
     * its connection itself, on a platform that can sleep.  NULL: the platform waits for the stream.
     */
    void (*wait)(uint64_t until_ns);
    /**
     * Returns the state of the connection as a word, such as "waiting" or "running".  The pointer changes only with it.
     */
    const char *(*state)(void);
    bool one_part; /**< `ros2 node info` does not find the node if its namespace has several parts */
} epg_middleware_t;

#endif
