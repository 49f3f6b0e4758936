/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A middleware: how setpoints reach a target and its values leave it.
 *
 * `targets/middlewares/<name>` holds one each, written once and free of any SDK; a platform gives it a stream (or a
 * socket of the middleware's own) and calls it.  All of it runs on the communication side: it may take its time, but
 * it never waits for the other end, and a broken connection is its own business.
 */
#ifndef EPG_MIDDLEWARE_H
#define EPG_MIDDLEWARE_H

#include <stdint.h>

#include "epg/stream.h"
#include "epg/target.h"

typedef struct epg_middleware {
    /** Once, before the first poll().  `stream` stays valid; NULL for a middleware that needs none. */
    void (*start)(const epg_target_t *target, const epg_stream_t *stream);
    /**
     * Does what is due at `now_ns` (epg_port_time_ns()) and returns.  Called again and again, at least once per
     * millisecond; setpoints that have arrived are delivered, values that are due are sent.
     */
    void (*poll)(uint64_t now_ns);
    /** The program ends: takes leave of the other end, without waiting for it.  NULL: there is nothing to do. */
    void (*stop)(void);
    /**
     * For a middleware with a connection of its own, on a platform that can sleep: returns when something has arrived,
     * at `until_ns` at the latest.  NULL: the platform waits for the stream.
     */
    void (*wait)(uint64_t until_ns);
    /** How its connection stands, in a word: "waiting", "running".  The same pointer while it is the same. */
    const char *(*state)(void);
} epg_middleware_t;

#endif
