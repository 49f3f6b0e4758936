/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The guard: checks each received frame before the client library gets it.
 *
 * The library trusts the agent.  It copies frames without checking the room for them.  It counts from one sequence
 * number to another, however far they are apart.  It takes a late acknowledgement for one of the next round.  But a
 * frame can be noise on a serial line, a datagram of an unknown sender, or a delayed one.
 *
 * The guard therefore reads each frame first.  It removes every submessage that is malformed, or that does not belong
 * to the present state of this session.  It also takes out the stream of the services, which the library does not know.
 */
#ifndef EPG_XRCE_GUARD_H
#define EPG_XRCE_GUARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uxr/client/client.h>
#include <uxr/client/util/ping.h>

#include "xrce_services.h"

typedef struct epg_xrce_guard {
    const uxrSession *session;
    epg_xrce_services_t *services; /**< gets what belongs to their stream; NULL: the target has no services */
    bool open;                     /**< the agent has accepted the session; before, only its acceptance passes */
    bool reading;                  /**< samples were requested; earlier ones belong to an older session */
    bool pong;                     /**< the agent has answered a ping and knows the session; the caller clears it */
    bool unknown; /**< the session is not usable any more, for example unknown to the agent; the caller clears it */
    bool taken;   /**< the guard itself has read a submessage of the present frame */
    uint32_t behind[2]; /**< heartbeats in a row of an agent that has sent fewer frames than were handled here, for the
                             library's stream and for that of the services */
    uint32_t dropped;   /**< frames that were removed as a whole */
} epg_xrce_guard_t;

/**
 * Removes the parts of `frame` that the library must not get.  Returns the remaining size, 0 if nothing remains.
 * `frame` must have room for at least 12 bytes.
 */
size_t epg_xrce_guard(epg_xrce_guard_t *guard, uint8_t *frame, size_t size);

#endif
