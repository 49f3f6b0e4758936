/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A type support for messages that are bytes already.
 *
 * rmw_microxrcedds publishes no serialised messages; but what its type supports do is to write a message into a buffer
 * and to read one from it.  This one copies; it is the same for all types but for their names.
 */
#ifndef EPG_MICRO_ROS_TYPE_H
#define EPG_MICRO_ROS_TYPE_H

#include <stdbool.h>
#include <stddef.h>

#include <rosidl_typesupport_microxrcedds_c/message_type_support.h>

#include "epg/message.h"

enum { EPG_MICRO_ROS_TYPE_NAME_SIZE = 100 };

/** A message that goes out. */
typedef struct epg_micro_ros_sent {
    const void *data;
    size_t size;
    bool *taken; /**< becomes true when all of it is in a stream of libmicroros */
} epg_micro_ros_sent_t;

/** A message that has come. */
typedef struct epg_micro_ros_received {
    unsigned char *data;
    size_t capacity; /**< of `data`; what is larger is left out */
    size_t size;
} epg_micro_ros_received_t;

typedef struct epg_micro_ros_type {
    rosidl_message_type_support_t support;
    message_type_support_callbacks_t callbacks;
    char name[EPG_MICRO_ROS_TYPE_NAME_SIZE];
} epg_micro_ros_type_t;

/** False: `message->type` is no name as ROS 2 makes them ("std_msgs::msg::dds_::Float64_"), or is too long. */
bool epg_micro_ros_type_make(epg_micro_ros_type_t *type, const epg_message_t *message);

#endif
