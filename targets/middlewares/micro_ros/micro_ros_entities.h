/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What a target is for rcl: a context, a node, and a publisher or subscription for each topic.
 *
 * Making them waits for the agent; taking them away does not.
 */
#ifndef EPG_MICRO_ROS_ENTITIES_H
#define EPG_MICRO_ROS_ENTITIES_H

#include <rcl/rcl.h>

#include "epg/node.h"
#include "micro_ros.h"

typedef struct epg_micro_ros_entities {
    const epg_node_t *node;
    const epg_micro_ros_options_t *options;
    rcl_context_t context;
    rcl_node_t rcl_node;
    size_t publishers; /**< that there are */
    size_t subscriptions;
    bool session; /**< there is a context, or was to be one */
    bool named;   /**< there is a node */
} epg_micro_ros_entities_t;

/** Asks the agent for a session under `client_key`, and for a node; false if it does not grant them. */
bool epg_micro_ros_entities_connect(epg_micro_ros_entities_t *entities, uint32_t client_key);

/** Makes the next publisher or subscription; false if the agent does not grant it.  `complete`: all are there. */
bool epg_micro_ros_entities_make(epg_micro_ros_entities_t *entities, bool *complete);

/** Gives all of it back, and tells the agent if it still listens. */
void epg_micro_ros_entities_drop(epg_micro_ros_entities_t *entities);

#endif
