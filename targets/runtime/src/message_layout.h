/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What messages of several numbers have in common: which of their numbers are values of a topic.
 */
#ifndef EPG_MESSAGE_LAYOUT_H
#define EPG_MESSAGE_LAYOUT_H

#include "epg/cdr.h"
#include "epg/target.h"

/** Values of a topic in the order of the message, some of whose numbers are none of them. */
typedef struct epg_layout_walk {
    const epg_topic_t *topic;
    const epg_message_layout_t *layout;
    const double *values;
    size_t next;
} epg_layout_walk_t;

static inline epg_layout_walk_t epg_layout_walk(const epg_topic_t *topic, const double *values)
{
    return (epg_layout_walk_t){.topic = topic, .layout = topic->layout, .values = values};
}

/** The value of number `field`, or `otherwise`; from call to call, `field` grows. */
static inline double epg_layout_value(epg_layout_walk_t *walk, size_t field, double otherwise)
{
    while (walk->next < walk->topic->count && walk->layout->fields[walk->next] < field) {
        walk->next++;
    }
    const bool there = walk->next < walk->topic->count && walk->layout->fields[walk->next] == field;
    return there ? walk->values[walk->next] : otherwise;
}

/** std_msgs/msg/Header. */
static inline void epg_write_header(epg_cdr_writer_t *writer, epg_stamp_t stamp, const char *frame_id)
{
    epg_cdr_write_i32(writer, stamp.seconds);
    epg_cdr_write_u32(writer, stamp.nanoseconds);
    epg_cdr_write_string(writer, frame_id);
}

/** The stamp of a message that arrives is its sender's, of whose clock nothing is known; so is the frame. */
static inline void epg_skip_header(epg_cdr_reader_t *reader)
{
    (void)epg_cdr_read_i32(reader);
    (void)epg_cdr_read_u32(reader);
    (void)epg_cdr_read_string(reader);
}

#endif
