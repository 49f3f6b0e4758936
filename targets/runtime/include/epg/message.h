/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * ROS 2 messages: how values of a target become a message, and how a message becomes values.
 *
 * A message type is one constant `epg_message_t`.  Those that EPG's component kinds use are declared here; a kind of
 * the user's may bring its own.  Types and hashes are those by which ROS 2 and DDS tell types apart (REP 2016).
 */
#ifndef EPG_MESSAGE_H
#define EPG_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct epg_topic;

/** What a message tells besides values. */
typedef struct epg_stamp {
    int32_t seconds; /**< since 1970 when the clock has been set, else since the board's start */
    uint32_t nanoseconds;
} epg_stamp_t;

typedef struct epg_message {
    const char *type; /**< as DDS names it: "std_msgs::msg::dds_::Float64_" */
    const char *hash; /**< "RIHS01_" and 64 hexadecimal digits */
    /**
     * Writes `topic->count` values as CDR (epg/cdr.h); `stamp` is the instant of the control cycle they are of.
     * Returns the bytes written, 0 if `size` is too small.  NULL: the type is for subscriptions only.
     */
    size_t (*write)(const struct epg_topic *topic, const double *values, epg_stamp_t stamp, void *data, size_t size);
    /**
     * Reads `topic->count` values; false if the message is malformed or is not for this topic.  NULL: the type is for
     * publications only.  `data` is what a stranger has sent.
     */
    bool (*read)(const struct epg_topic *topic, const void *data, size_t size, double *values);
} epg_message_t;

/** Most elements, or joints, of a message. */
enum { EPG_MESSAGE_ELEMENTS = 32 };

/** `layout` of a topic with one of the messages of several numbers. */
typedef struct epg_message_layout {
    const uint8_t *fields;    /**< for each value of the topic, which number of the message it is; ascending */
    size_t count;             /**< elements or joints, 1 ... EPG_MESSAGE_ELEMENTS */
    const char *const *names; /**< of the joints; else NULL */
    const char *frame_id;     /**< of a message with a header; "" for none */
} epg_message_layout_t;

extern const epg_message_t epg_message_float64; /**< std_msgs/msg/Float64 */
extern const epg_message_t epg_message_float32; /**< std_msgs/msg/Float32; a value beyond its range becomes infinite */
extern const epg_message_t epg_message_int32;   /**< std_msgs/msg/Int32; values are rounded and limited */
extern const epg_message_t epg_message_bool;    /**< std_msgs/msg/Bool; true is 1, and what exceeds 0.5 is true */

/**
 * std_msgs/msg/Float64MultiArray; `fields` are elements.  Elements without a value are 0.  Only arrays of exactly
 * `count` elements (behind `data_offset`) are read.
 */
extern const epg_message_t epg_message_float64_array;

/** geometry_msgs/msg/Twist; `fields` 0 ... 5 are linear x, y, z, angular x, y, z.  Those without a value are 0. */
extern const epg_message_t epg_message_twist;

/** geometry_msgs/msg/TwistStamped; the same with a header. */
extern const epg_message_t epg_message_twist_stamped;

/**
 * sensor_msgs/msg/JointState; `fields` are 3 * joint + 0 (position), 1 (velocity) or 2 (effort).  Of positions,
 * velocities and efforts, those are left out that no joint has; of those that some joints have, the others' are NaN.
 * A message is read if it has all of the topic's values, in whatever order its joints are.
 */
extern const epg_message_t epg_message_joint_state;

#endif
