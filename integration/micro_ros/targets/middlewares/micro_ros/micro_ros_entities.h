/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The rcl objects of a target: a context, a node, and a publisher or subscription for each topic.
 *
 * Their creation waits for the agent; their destruction does not.
 */
#ifndef EPG_MICRO_ROS_ENTITIES_H
#define EPG_MICRO_ROS_ENTITIES_H

#include <rcl/rcl.h>

#include "epg/node.h"
#include "micro_ros_options.h"

typedef struct epg_micro_ros_entities {
    const epg_node_t *node;
    const epg_micro_ros_options_t *options;
    rcl_context_t context;
    rcl_node_t rcl_node;
    size_t publishers;    /**< number of publishers created so far */
    size_t subscriptions; /**< number of subscriptions created so far */
    bool session;         /**< the context exists, or its creation has begun */
    bool named;           /**< the node exists */
} epg_micro_ros_entities_t;

/** Requests a session for `client_key` and a node.  Returns false if the agent does not grant them. */
bool epg_micro_ros_entities_connect(epg_micro_ros_entities_t *entities, uint32_t client_key);

/**
 * Creates the next publisher or subscription.  Returns false if the agent does not grant it.  `*complete` becomes true
 * when all of them exist.
 */
bool epg_micro_ros_entities_make(epg_micro_ros_entities_t *entities, bool *complete);

/** Destroys all objects and frees their memory.  Informs the agent, but does not wait for its answer. */
void epg_micro_ros_entities_drop(epg_micro_ros_entities_t *entities);

#endif
