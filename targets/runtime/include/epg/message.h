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
    int32_t
        seconds; /**< since 1970, or in simulated time; both members are 0 if the clock is not set (epg/wall_clock.h) */
    uint32_t nanoseconds;
} epg_stamp_t;

/**
 * The hash of a type, for `epg_message_t` and `epg_service_type_t`.  A middleware that needs it compiles the runtime with
 * EPG_TYPE_HASHES=1; otherwise it is NULL, which saves 72 bytes for each type.
 */
#if defined(EPG_TYPE_HASHES) && EPG_TYPE_HASHES
#define EPG_TYPE_HASH(text) text
#else
#define EPG_TYPE_HASH(text) NULL
#endif

/** A message type. */
typedef struct epg_message {
    const char *type; /**< its name in DDS: "std_msgs::msg::dds_::Float64_" */
    const char *hash; /**< EPG_TYPE_HASH() of "RIHS01_" and 64 hexadecimal digits */
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
    bool stamped; /**< it contains the stamp, so its topics wait for the clock after a start, for at most 1 s */
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

extern const epg_message_t epg_message_clock; /**< rosgraph_msgs/msg/Clock; its only content is the stamp */

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

/** The type of a field in a message that tables describe. */
typedef enum epg_field_type {
    EPG_FIELD_BOOL,
    EPG_FIELD_INT8,
    EPG_FIELD_UINT8,
    EPG_FIELD_INT16,
    EPG_FIELD_UINT16,
    EPG_FIELD_INT32,
    EPG_FIELD_UINT32,
    EPG_FIELD_INT64,
    EPG_FIELD_UINT64,
    EPG_FIELD_FLOAT32,
    EPG_FIELD_FLOAT64,
    EPG_FIELD_STRING,
    EPG_FIELD_STAMP /**< builtin_interfaces/msg/Time: the time of the control cycle */
} epg_field_type_t;

/** The place of a number or of a stamp in a message that is sent. */
typedef struct epg_message_place {
    uint16_t offset; /**< from the start of the message, in bytes */
    uint8_t type;    /**< epg_field_type_t */
} epg_message_place_t;

/** The `value` of a step whose numbers are not values of the topic. */
#define EPG_STEP_SKIP UINT16_MAX

/** One step of reading a message that is received. */
typedef struct epg_message_step {
    uint8_t type;   /**< epg_field_type_t, not EPG_FIELD_STAMP */
    bool sequence;  /**< a sequence of this type, of any length, which is skipped */
    uint16_t count; /**< number of elements; 1 for a single field */
    uint16_t value; /**< index of the value that the number gives, or EPG_STEP_SKIP */
} epg_message_step_t;

/**
 * A message of any type, described by constant tables.
 *
 * The first member is the message of its topics.  A message that is sent is `data`, with the values of the topic and the
 * stamps in their places: first a place for each value, then the stamps.  Texts and sequences are therefore constant.
 * In a message that is received, texts and sequences can have any length; it is read in steps.
 */
typedef struct epg_message_table {
    epg_message_t message;
    const uint8_t *data;
    size_t size;
    const epg_message_place_t *places;
    size_t place_count;
    const epg_message_step_t *steps;
    size_t step_count;
} epg_message_table_t;

/** The function `write` of a message in an `epg_message_table_t`. */
size_t epg_message_table_write(const struct epg_topic *topic, const double *values, epg_stamp_t stamp, void *data,
                               size_t size);

/** The function `read` of a message in an `epg_message_table_t`.  A Boolean value other than 0 and 1 is malformed. */
bool epg_message_table_read(const struct epg_topic *topic, const void *data, size_t size, double *values);

#endif
