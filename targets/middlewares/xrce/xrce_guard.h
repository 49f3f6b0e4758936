/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What of a received frame the client library gets to see.
 *
 * The library trusts the agent: it copies frames without looking at the room there is, counts from one sequence number
 * to another however far they are apart, and takes an acknowledgement that comes late for one of the next round.  What
 * arrives may be noise of a serial line, a datagram of a stranger, or a late one; so each frame is read here first, and
 * what is not a well-formed submessage that belongs to this session as it stands is taken out.
 */
#ifndef EPG_XRCE_GUARD_H
#define EPG_XRCE_GUARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uxr/client/client.h>
#include <uxr/client/util/ping.h>

/** The id of the session; one from 0x80 on stands for the client's key in each frame. */
#define EPG_XRCE_SESSION_ID 0x81

typedef struct epg_xrce_guard {
    const uxrSession *session;
    bool open;        /**< the agent has accepted the session; before, nothing but that it has is let through */
    bool reading;     /**< samples have been asked for; those that come before are of an older session */
    bool pong;        /**< the agent has answered a ping, and knows the session; the reader clears it */
    bool unknown;     /**< the agent has answered a ping, and does not know the session; the reader clears it */
    uint32_t behind;  /**< heartbeats in a row of an agent that has sent less than has been handled */
    uint32_t dropped; /**< frames of which nothing was let through */
} epg_xrce_guard_t;

/**
 * Takes out of `frame` what the library must not see; returns the size of what is left, 0 if that is nothing.
 * `frame` has room for 12 bytes at least.
 */
size_t epg_xrce_guard(epg_xrce_guard_t *guard, uint8_t *frame, size_t size);

#endif
