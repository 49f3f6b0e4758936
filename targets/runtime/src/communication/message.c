/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Messages of std_msgs that hold one number.
 */
#include "epg/message.h"

#include <limits.h>

#include "epg/cdr.h"
#include "epg/target.h"

static size_t write_float64(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    (void)topic;
    (void)stamp;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_cdr_write_f64(&writer, values[0]);
    return writer.failed ? 0 : writer.length;
}

static bool read_float64(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    (void)topic;
    epg_cdr_reader_t reader = {.data = data, .size = size};
    values[0] = epg_cdr_read_f64(&reader);
    return !reader.failed;
}

static size_t write_float32(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    (void)topic;
    (void)stamp;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_cdr_write_f32(&writer, (float)values[0]);
    return writer.failed ? 0 : writer.length;
}

static bool read_float32(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    (void)topic;
    epg_cdr_reader_t reader = {.data = data, .size = size};
    values[0] = (double)epg_cdr_read_f32(&reader);
    return !reader.failed;
}

/** Returns the nearest whole number; halves are rounded away from zero, and NaN is 0. */
static int32_t whole(double value)
{
    const double moved = value < 0.0 ? value - 0.5 : value + 0.5;
    if (moved >= (double)INT32_MAX) {
        return INT32_MAX;
    }
    if (moved <= (double)INT32_MIN) {
        return INT32_MIN;
    }
    return moved == moved ? (int32_t)moved : 0;
}

static size_t write_int32(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    (void)topic;
    (void)stamp;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_cdr_write_i32(&writer, whole(values[0]));
    return writer.failed ? 0 : writer.length;
}

static bool read_int32(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    (void)topic;
    epg_cdr_reader_t reader = {.data = data, .size = size};
    values[0] = (double)epg_cdr_read_i32(&reader);
    return !reader.failed;
}

static size_t write_bool(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    (void)topic;
    (void)stamp;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_cdr_write_u8(&writer, values[0] > 0.5 ? 1 : 0);
    return writer.failed ? 0 : writer.length;
}

static bool read_bool(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    (void)topic;
    epg_cdr_reader_t reader = {.data = data, .size = size};
    const uint8_t value = epg_cdr_read_u8(&reader);
    values[0] = (double)value;
    return !reader.failed && value <= 1;
}

const epg_message_t epg_message_float64 = {
    .type = "std_msgs::msg::dds_::Float64_",
    .hash = EPG_TYPE_HASH("RIHS01_705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a"),
    .write = write_float64,
    .read = read_float64,
};

const epg_message_t epg_message_float32 = {
    .type = "std_msgs::msg::dds_::Float32_",
    .hash = EPG_TYPE_HASH("RIHS01_7170d3d8f841f7be3172ce5f4f59f3a4d7f63b0447e8b33327601ad64d83d6e2"),
    .write = write_float32,
    .read = read_float32,
};

const epg_message_t epg_message_int32 = {
    .type = "std_msgs::msg::dds_::Int32_",
    .hash = EPG_TYPE_HASH("RIHS01_b6578ded3c58c626cfe8d1a6fb6e04f706f97e9f03d2727c9ff4e74b1cef0deb"),
    .write = write_int32,
    .read = read_int32,
};

const epg_message_t epg_message_bool = {
    .type = "std_msgs::msg::dds_::Bool_",
    .hash = EPG_TYPE_HASH("RIHS01_feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9"),
    .write = write_bool,
    .read = read_bool,
};
