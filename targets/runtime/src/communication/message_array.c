/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * std_msgs/msg/Float64MultiArray: a layout of dimensions (label, size, stride) and an offset, then the numbers.
 *
 * A publication is one-dimensional.  It does not describe its dimension: its `dim` is empty, which std_msgs allows.
 */
#include "epg/message.h"

#include "message_layout.h"

static size_t write_array(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    (void)stamp;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_layout_walk_t walk = epg_layout_walk(topic, values);
    epg_cdr_write_u32(&writer, 0); /* layout.dim */
    epg_cdr_write_u32(&writer, 0); /* layout.data_offset */
    epg_cdr_write_u32(&writer, (uint32_t)walk.layout->count);
    for (size_t i = 0; i < walk.layout->count; i++) {
        epg_cdr_write_f64(&writer, epg_layout_value(&walk, i, 0.0));
    }
    return writer.failed ? 0 : writer.length;
}

static bool read_array(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    const epg_message_layout_t *layout = topic->layout;
    epg_cdr_reader_t reader = {.data = data, .size = size};
    size_t first;
    const uint32_t dimensions = epg_cdr_read_u32(&reader);
    for (uint32_t i = 0; i < dimensions && !reader.failed; i++) {
        (void)epg_cdr_read_string(&reader);
        (void)epg_cdr_read_u32(&reader);
        (void)epg_cdr_read_u32(&reader);
    }
    const size_t offset = epg_cdr_read_u32(&reader);
    const size_t count = epg_cdr_read_sequence(&reader, sizeof(double), &first);
    if (reader.failed || offset > count || count - offset != layout->count) {
        return false;
    }
    for (size_t i = 0; i < topic->count; i++) {
        reader.position = first + (offset + layout->fields[i]) * sizeof(double);
        values[i] = epg_cdr_read_f64(&reader);
    }
    return !reader.failed;
}

const epg_message_t epg_message_float64_array = {
    .type = "std_msgs::msg::dds_::Float64MultiArray_",
    .hash = EPG_TYPE_HASH("RIHS01_1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f"),
    .write = write_array,
    .read = read_array,
};
