/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Services: requests from the agent, and the replies to them.
 *
 * Requests and replies have a reliable stream of their own in each direction, beside those of the topics.  A large reply
 * therefore never delays a reliable publication, and a request that must wait never delays a setpoint.  The client
 * library does not know this stream, because its streams need a copy of every frame:
 *
 * - A frame is received only in its turn, and not while a request is in work.  The agent keeps the frames that were not
 *   acknowledged and sends them again, so requests wait at the agent.  The fragments of a request are collected in the
 *   node's buffer for requests.
 * - A reply is written frame by frame.  A frame that was lost is written again from the reply, so no copy is kept.
 * - An agent that still has an older session of this client keeps the fragments of an unfinished reply.  The first frame
 *   of a session therefore is an empty last fragment, after which the agent drops them.
 *
 * An object of this type belongs to one session.  Frames are received during the poll and sent at its end.
 */
#ifndef EPG_XRCE_SERVICES_H
#define EPG_XRCE_SERVICES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/node.h"
#include "xrce_link.h"

/** The id of the session.  With an id of 0x80 or more, frames do not contain the client's key. */
#define EPG_XRCE_SESSION_ID 0x81

/** The number of the stream, in both directions.  The library uses 0x80 for the reliable topics. */
#define EPG_XRCE_SERVICE_STREAM 0x81

/** Bytes before the data of a request or reply: header of the submessage, ids, identity of the request in DDS. */
enum { EPG_XRCE_IDENTITY = 24, EPG_XRCE_SERVICE_HEAD = 8 + EPG_XRCE_IDENTITY };

typedef struct epg_xrce_services {
    epg_node_t *node;
    epg_xrce_link_t *link;
    uint8_t *frame;    /**< room for a frame that is sent; its content is not kept from one poll to the next */
    size_t frame_size; /**< bytes of the largest frame that is sent */
    uint64_t now_ns;   /**< board time of this poll */

    /* Requests */
    uint16_t expected;                   /**< number of the next frame from the agent */
    uint16_t announced;                  /**< number after the newest frame that the agent is known to have sent */
    bool acknowledge;                    /**< an ACKNACK must be sent */
    bool held;                           /**< a frame was refused because a request is in work */
    uint16_t stopped;                    /**< bit i: frame `expected` + i, which waits, has stopped the target */
    uint16_t stale;                      /**< frames from `expected` on that arrived before a stop of something else */
    size_t collected;                    /**< bytes of the submessage whose fragments have arrived so far */
    uint8_t head[EPG_XRCE_SERVICE_HEAD]; /**< its first bytes; those after them are in the node's buffer */

    /* The reply */
    bool opening;                           /**< the only frame is the empty fragment that begins a session */
    uint8_t request[EPG_XRCE_SERVICE_HEAD]; /**< `head` of the request in work */
    uint16_t count;                         /**< number of its frames; 0: there is no reply yet */
    uint16_t first;                         /**< number of its first frame */
    uint16_t unacknowledged;                /**< number of the first frame that the agent has not acknowledged */
    uint16_t next;                          /**< number of the next frame that is sent for the first time */
    uint16_t missing;                       /**< bit i: the agent has asked for frame `unacknowledged` + i again */
    uint64_t heartbeat_ns;                  /**< next request for an acknowledgement */
} epg_xrce_services_t;

/** Starts a new session.  Ends the work on a request of the session before. */
void epg_xrce_services_start(epg_xrce_services_t *services);

/** Returns the number in the object id of the replier of service `index`. */
static inline uint16_t epg_xrce_services_id(size_t index)
{
    return (uint16_t)(index + 1);
}

/**
 * Receives the submessages of frame `number`, without the frame's header.  With `ignore`, the frame is acknowledged, but
 * its content belongs to an older session.  Returns false if the frame is malformed.
 */
bool epg_xrce_services_receive(epg_xrce_services_t *services, uint16_t number, const uint8_t *body, size_t size,
                               bool ignore);

/** Returns true if the agent has announced frames that can be received now, but are not here. */
bool epg_xrce_services_lack_frames(const epg_xrce_services_t *services);

/** Handles the agent's ACKNACK: the number of the first missing frame, and the bits of the missing frames. */
void epg_xrce_services_acknowledge(epg_xrce_services_t *services, uint16_t first_missing, uint16_t missing);

/** Handles the agent's HEARTBEAT; `last` is the number of the newest frame that it has sent. */
void epg_xrce_services_heartbeat(epg_xrce_services_t *services, uint16_t last);

/** Continues the request in work, and sends the frames that are due, as far as the transport has room. */
void epg_xrce_services_poll(epg_xrce_services_t *services, uint64_t now_ns);

#endif
