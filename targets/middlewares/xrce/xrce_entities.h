/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The entities of a target in DDS, which the agent creates on request.
 *
 * They are a participant, a publisher and a subscriber, and for each topic the topic itself and its writer or reader.
 * Each service has a replier, which has its own topics.  At the end, the samples of the readers and the requests of the
 * services are requested.
 */
#ifndef EPG_XRCE_ENTITIES_H
#define EPG_XRCE_ENTITIES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uxr/client/client.h>

#include "epg/node.h"

typedef struct epg_xrce_entities {
    const epg_node_t *node;
    uxrSession *session;
    uxrStreamId requests;    /**< output stream for the requests */
    uxrStreamId reliable;    /**< input stream for samples of reliable topics */
    uxrStreamId best_effort; /**< input stream for samples of the other topics */
    size_t step;             /**< number of the next request */
    uint16_t request;        /**< request that is not answered yet; UXR_INVALID_REQUEST_ID: none */
    uint8_t status;          /**< answer of the agent; UXR_STATUS_NONE: there is none yet */
} epg_xrce_entities_t;

/** The progress of the creation. */
typedef enum epg_xrce_progress {
    EPG_XRCE_UNDERWAY,
    EPG_XRCE_REFUSED, /**< the agent refused a request */
    EPG_XRCE_COMPLETE /**< all entities exist, and all samples are requested */
} epg_xrce_progress_t;

/** Returns the id of a writer: the index of its publication, plus 1.  Readers are numbered separately. */
static inline uxrObjectId epg_xrce_writer(size_t publication)
{
    return uxr_object_id((uint16_t)(publication + 1), UXR_DATAWRITER_ID);
}

/** Restarts the creation with the first entity. */
void epg_xrce_entities_start(epg_xrce_entities_t *entities);

/** Must be called when the agent has answered request `request`. */
void epg_xrce_entities_answer(epg_xrce_entities_t *entities, uint16_t request, uint8_t status);

/**
 * Sends the next request if the last one was granted.  Only one request is sent at a time, because the next entities
 * refer to this one.
 */
epg_xrce_progress_t epg_xrce_entities_poll(epg_xrce_entities_t *entities);

/** Returns true if all entities exist; only samples may still have to be requested. */
bool epg_xrce_entities_exist(const epg_xrce_entities_t *entities);

#endif
