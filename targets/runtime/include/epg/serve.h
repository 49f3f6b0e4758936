/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What every platform with transports does with them and with its middlewares, on the communication side.
 *
 * Inline, so that it lies where the platform's own code does.  A middleware or a transport that is NULL is not there.
 */
#ifndef EPG_SERVE_H
#define EPG_SERVE_H

#include <stdbool.h>
#include <stddef.h>

#include "epg/middleware.h"
#include "epg/port.h"
#include "epg/target.h"
#include "epg/transport.h"

/** False when the transport cannot be started; `title` as in epg_transport_t. */
static inline bool epg_serve_start_transport(const epg_transport_t *transport, const char *title)
{
    return transport == NULL || transport->start(transport->stream.context, title);
}

static inline void epg_serve_start_middleware(const epg_target_t *target, const epg_middleware_t *middleware,
                                              const epg_transport_t *transport)
{
    if (middleware != NULL) {
        middleware->start(target, transport != NULL ? &transport->stream : NULL);
    }
}

/** What the middleware has written goes out. */
static inline void epg_serve_flush(const epg_transport_t *transport)
{
    if (transport != NULL && transport->flush != NULL) {
        transport->flush(transport->stream.context);
    }
}

/** One turn of a middleware and its transport. */
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
