/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * geometry_msgs/msg/Twist and TwistStamped: linear x, y, z, then angular x, y, z.
 */
#include "epg/message.h"

#include "message_layout.h"

enum { NUMBERS = 6 };

static size_t write_numbers(epg_cdr_writer_t *writer, const epg_topic_t *topic, const double *values)
{
    epg_layout_walk_t walk = epg_layout_walk(topic, values);
    for (size_t i = 0; i < NUMBERS; i++) {
        epg_cdr_write_f64(writer, epg_layout_value(&walk, i, 0.0));
    }
    return writer->failed ? 0 : writer->length;
}

static bool read_numbers(epg_cdr_reader_t *reader, const epg_topic_t *topic, double *values)
{
    const epg_message_layout_t *layout = topic->layout;
    double numbers[NUMBERS];
    for (size_t i = 0; i < NUMBERS; i++) {
        numbers[i] = epg_cdr_read_f64(reader);
    }
    for (size_t i = 0; i < topic->count; i++) {
        values[i] = numbers[layout->fields[i]];
    }
    return !reader->failed;
}

static size_t write_twist(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    (void)stamp;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    return write_numbers(&writer, topic, values);
}

static bool read_twist(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    epg_cdr_reader_t reader = {.data = data, .size = size};
    return read_numbers(&reader, topic, values);
}

static size_t write_stamped(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    const epg_message_layout_t *layout = topic->layout;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_write_header(&writer, stamp, layout->frame_id);
    return write_numbers(&writer, topic, values);
}

static bool read_stamped(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    epg_cdr_reader_t reader = {.data = data, .size = size};
    epg_skip_header(&reader);
    return read_numbers(&reader, topic, values);
}

const epg_message_t epg_message_twist = {
    .type = "geometry_msgs::msg::dds_::Twist_",
    .hash = EPG_TYPE_HASH("RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"),
    .write = write_twist,
    .read = read_twist,
};

const epg_message_t epg_message_twist_stamped = {
    .type = "geometry_msgs::msg::dds_::TwistStamped_",
    .hash = EPG_TYPE_HASH("RIHS01_5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"),
    .write = write_stamped,
    .read = read_stamped,
    .stamped = true,
};
