/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The turn of the communication side, which all platforms with transports share: start, poll and flush.
 *
 * The functions are inline, so that their code is in the same memory (flash or RAM) as the platform's code that calls
 * them.  A middleware or a transport that does not exist is NULL.
 */
#ifndef EPG_SERVE_H
#define EPG_SERVE_H

#include <stdbool.h>
#include <stddef.h>

#include "epg/middleware.h"
#include "epg/port.h"
#include "epg/target.h"
#include "epg/transport.h"

/** Starts a transport.  Returns false if that is impossible.  `title` is as in epg_transport_t. */
static inline bool epg_serve_start_transport(const epg_transport_t *transport, const char *title)
{
    return transport == NULL || transport->start(transport->stream.context, title);
}

/** Starts a middleware on the stream of `transport`. */
static inline void epg_serve_start_middleware(const epg_target_t *target, const epg_middleware_t *middleware,
                                              const epg_transport_t *transport)
{
    if (middleware != NULL) {
        middleware->start(target, transport != NULL ? &transport->stream : NULL);
    }
}

/** Sends the bytes that the middleware has written. */
static inline void epg_serve_flush(const epg_transport_t *transport)
{
    if (transport != NULL && transport->flush != NULL) {
        transport->flush(transport->stream.context);
    }
}

/** Makes one turn: serves the transport, then the middleware, then sends the written bytes. */
static inline void epg_serve(const epg_middleware_t *middleware, const epg_transport_t *transport)
{
    if (transport != NULL && transport->poll != NULL) {
        transport->poll(transport->stream.context);
    }
    if (middleware != NULL) {
        middleware->poll(epg_port_time_ns());
    }
    epg_serve_flush(transport);
}

#endif
