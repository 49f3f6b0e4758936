/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A type support for messages that are already serialised.
 *
 * rmw_microxrcedds has no function to publish a serialised message.  But it calls the type support of a message to
 * write the message into a buffer, or to read one from it.  The type support here only copies the bytes.  It is the
 * same for all types, except for their names.
 */
#ifndef EPG_MICRO_ROS_TYPE_H
#define EPG_MICRO_ROS_TYPE_H

#include <stdbool.h>
#include <stddef.h>

#include <rosidl_typesupport_microxrcedds_c/message_type_support.h>

#include "epg/message.h"

enum { EPG_MICRO_ROS_TYPE_NAME_SIZE = 100 };

/** A message to send. */
typedef struct epg_micro_ros_sent {
    const void *data;
    size_t size;
    bool *taken; /**< becomes true when the whole message is in a stream of libmicroros */
} epg_micro_ros_sent_t;

/** A received message. */
typedef struct epg_micro_ros_received {
    unsigned char *data;
    size_t capacity; /**< size of `data`; a larger message is dropped */
    size_t size;
} epg_micro_ros_received_t;

typedef struct epg_micro_ros_type {
    rosidl_message_type_support_t support;
    message_type_support_callbacks_t callbacks;
    char name[EPG_MICRO_ROS_TYPE_NAME_SIZE];
} epg_micro_ros_type_t;

/** Returns false if `message->type` is not a type name of ROS 2 ("std_msgs::msg::dds_::Float64_"), or is too long. */
bool epg_micro_ros_type_make(epg_micro_ros_type_t *type, const epg_message_t *message);

#endif
