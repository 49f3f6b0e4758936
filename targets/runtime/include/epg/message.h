/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * ROS 2 messages: conversions between the values of a target and the bytes of a message.
 *
 * Each message type is one constant `epg_message_t`.  This file declares the types that EPG's component kinds use; a
 * user's kind may define its own.  DDS identifies a type by its name, ROS 2 also by the hash of its definition
 * (REP 2016).
 */
#ifndef EPG_MESSAGE_H
#define EPG_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct epg_topic;

/** The time stamp of a message: the instant of the control cycle to which its values belong. */
typedef struct epg_stamp {
    int32_t seconds; /**< since 1970 if the clock has been set, otherwise since the board's start */
    uint32_t nanoseconds;
} epg_stamp_t;

/** A message type. */
typedef struct epg_message {
    const char *type; /**< its name in DDS: "std_msgs::msg::dds_::Float64_" */
    const char *hash; /**< "RIHS01_" and 64 hexadecimal digits */
    /**
     * Writes `topic->count` values with their time stamp as CDR (epg/cdr.h).  Returns the number of bytes written, 0 if
     * `size` is too small.  NULL: the type can only be subscribed to.
     */
    size_t (*write)(const struct epg_topic *topic, const double *values, epg_stamp_t stamp, void *data, size_t size);
    /**
     * Reads `topic->count` values.  Returns false if the message is malformed or does not belong to this topic.  `data`
     * comes from the network, so it must not be trusted.  NULL: the type can only be published.
     */
    bool (*read)(const struct epg_topic *topic, const void *data, size_t size, double *values);
} epg_message_t;

/** Largest number of elements, or of joints, in a message. */
enum { EPG_MESSAGE_ELEMENTS = 32 };

/** The `layout` of a topic whose message holds several numbers. */
typedef struct epg_message_layout {
    const uint8_t *fields;    /**< for each value of the topic, the index of its number in the message; ascending */
    size_t count;             /**< number of elements or joints, 1 ... EPG_MESSAGE_ELEMENTS */
    const char *const *names; /**< names of the joints; NULL for other messages */
    const char *frame_id;     /**< frame of a message with a header; "" for none */
} epg_message_layout_t;

extern const epg_message_t epg_message_float64; /**< std_msgs/msg/Float64 */
extern const epg_message_t epg_message_float32; /**< std_msgs/msg/Float32; a value beyond its range becomes infinite */
extern const epg_message_t epg_message_int32;   /**< std_msgs/msg/Int32; values are rounded and limited to its range */
extern const epg_message_t epg_message_bool;    /**< std_msgs/msg/Bool; a value above 0.5 is true; true is read as 1 */

/**
 * std_msgs/msg/Float64MultiArray.  A field is the index of an element.  Elements without a value are written as 0.  An
 * array is read only if it has exactly `count` elements after its `data_offset`.
 */
extern const epg_message_t epg_message_float64_array;

/**
 * geometry_msgs/msg/Twist.  The fields 0 ... 5 are linear x, y, z, angular x, y, z.  Fields without a value are written
 * as 0.
 */
extern const epg_message_t epg_message_twist;

/** geometry_msgs/msg/TwistStamped: as Twist, with a header. */
extern const epg_message_t epg_message_twist_stamped;

/**
 * sensor_msgs/msg/JointState.  A field is 3 * joint + 0 (position), 1 (velocity) or 2 (effort).
 *
 * If no joint has a position, the array of positions is left out.  If only some joints have one, the others are NaN.
 * The same holds for velocities and efforts.  A message is read if it has all of the topic's values; the order of its
 * joints does not matter.
 */
extern const epg_message_t epg_message_joint_state;

#endif
