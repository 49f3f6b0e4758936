/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middleware `micro_ros`: ROS 2 through an agent, with rcl and micro-ROS's library libmicroros.
 *
 * epg/node.h serialises the messages, and libmicroros carries their bytes.  Some calls of libmicroros wait for the
 * agent; docs/micro-ros.md lists them with their longest times.  An executable can contain one such node.
 */
#ifndef EPG_MICRO_ROS_H
#define EPG_MICRO_ROS_H

#include <rcl/publisher.h>
#include <rcl/subscription.h>

#include "epg/middleware.h"
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

extern const epg_middleware_t epg_micro_ros;

#endif
