/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Messages of several numbers, of which only some are values of a topic.
 *
 * The layout of a topic lists the places of its values in the message, in ascending order.
 */
#ifndef EPG_MESSAGE_LAYOUT_H
#define EPG_MESSAGE_LAYOUT_H

#include "epg/cdr.h"
#include "epg/target.h"

/** A walk through the numbers of a message, which finds the topic's value for each. */
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

/** Returns the value of number `field`, or `otherwise` if it has none.  `field` must grow from call to call. */
static inline double epg_layout_value(epg_layout_walk_t *walk, size_t field, double otherwise)
{
    while (walk->next < walk->topic->count && walk->layout->fields[walk->next] < field) {
        walk->next++;
    }
    const bool there = walk->next < walk->topic->count && walk->layout->fields[walk->next] == field;
    return there ? walk->values[walk->next] : otherwise;
}

/** Writes a std_msgs/msg/Header. */
static inline void epg_write_header(epg_cdr_writer_t *writer, epg_stamp_t stamp, const char *frame_id)
{
    epg_cdr_write_i32(writer, stamp.seconds);
    epg_cdr_write_u32(writer, stamp.nanoseconds);
    epg_cdr_write_string(writer, frame_id);
}

/** Skips a std_msgs/msg/Header.  Its stamp is ignored, because the sender's clock is unknown; so is its frame. */
static inline void epg_skip_header(epg_cdr_reader_t *reader)
{
    (void)epg_cdr_read_i32(reader);
    (void)epg_cdr_read_u32(reader);
    (void)epg_cdr_read_string(reader);
}

#endif
