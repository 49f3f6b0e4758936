/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * ROS 2 through an agent: the middleware `micro_ros`, on rcl and micro-ROS's libmicroros.  docs/micro-ros.md says what
 * of it waits, and for how long.
 *
 * There is one in an executable.  Messages are serialised by epg/node.h; libmicroros carries their bytes.
 */
#ifndef EPG_MICRO_ROS_H
#define EPG_MICRO_ROS_H

#include <rcl/publisher.h>
#include <rcl/subscription.h>

#include "epg/middleware.h"
#include "micro_ros_type.h"

/** Memory of the generator's. */
typedef struct epg_micro_ros_options {
    rcl_publisher_t *publishers;       /**< one per publication */
    rcl_subscription_t *subscriptions; /**< one per subscription */
    void **ready;                      /**< one per subscription: those that a message has come for */
    epg_micro_ros_type_t *types;       /**< one per publication, then one per subscription */
    size_t received_size;
    unsigned char *received; /**< `received_size` bytes: of the largest message that a subscription takes */
    size_t memory_size;
    void *memory; /**< `memory_size` bytes for what rcl allocates */
} epg_micro_ros_options_t;

extern const epg_middleware_t epg_micro_ros;

#endif
