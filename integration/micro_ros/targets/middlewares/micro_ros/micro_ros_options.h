/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The memory of the node.
 */
#ifndef EPG_MICRO_ROS_OPTIONS_H
#define EPG_MICRO_ROS_OPTIONS_H

#include <rcl/publisher.h>
#include <rcl/subscription.h>

#include "micro_ros_type.h"

/** The memory that the generator defines for the node. */
typedef struct epg_micro_ros_options {
    rcl_publisher_t *publishers;       /**< one per publication */
    rcl_subscription_t *subscriptions; /**< one per subscription */
    void **ready;                      /**< one per subscription: not NULL if a message has arrived for it */
    epg_micro_ros_type_t *types;       /**< one per publication, then one per subscription */
    size_t received_size;
    unsigned char *received; /**< `received_size` bytes: room for the largest message of a subscription */
    size_t memory_size;
    void *memory; /**< `memory_size` bytes, from which rcl allocates */
} epg_micro_ros_options_t;

#endif
