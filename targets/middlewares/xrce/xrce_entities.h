/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What a target asks an agent for: a participant, a publisher and a subscriber, and for each topic the topic and its
 * writer or reader; last the samples of the readers.
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
    uxrStreamId requests; /**< the output stream on which is asked */
    uxrStreamId reliable; /**< input streams that samples come on */
    uxrStreamId best_effort;
    size_t step;      /**< what is asked for next */
    uint16_t request; /**< that is not answered yet; UXR_INVALID_REQUEST_ID: none */
    uint8_t status;   /**< the answer; UXR_STATUS_NONE: there is none yet */
} epg_xrce_entities_t;

typedef enum epg_xrce_progress {
    EPG_XRCE_UNDERWAY,
    EPG_XRCE_REFUSED, /**< the agent has said no */
    EPG_XRCE_COMPLETE /**< all has been created, and samples have been asked for */
} epg_xrce_progress_t;

/** Number of a writer: that of its publication, from 1 on.  Readers count apart. */
static inline uxrObjectId epg_xrce_writer(size_t publication)
{
    return uxr_object_id((uint16_t)(publication + 1), UXR_DATAWRITER_ID);
}

/** From the beginning. */
void epg_xrce_entities_start(epg_xrce_entities_t *entities);

/** The agent has answered request `request`. */
void epg_xrce_entities_answer(epg_xrce_entities_t *entities, uint16_t request, uint8_t status);

/** Asks for what comes next when the last request has been granted.  One at a time: what follows refers to it. */
epg_xrce_progress_t epg_xrce_entities_poll(epg_xrce_entities_t *entities);

/** Samples are being asked for, all else is there. */
bool epg_xrce_entities_exist(const epg_xrce_entities_t *entities);

#endif
