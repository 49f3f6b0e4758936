/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * rosgraph_msgs/msg/Clock.
 */
#include "epg/cdr.h"
#include "epg/message.h"

static size_t write_clock(const struct epg_topic *topic, const double *values, epg_stamp_t stamp, void *data,
                          size_t size)
{
    (void)topic;
    (void)values;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_cdr_write_i32(&writer, stamp.seconds);
    epg_cdr_write_u32(&writer, stamp.nanoseconds);
    return writer.failed ? 0 : writer.length;
}

const epg_message_t epg_message_clock = {
    .type = "rosgraph_msgs::msg::dds_::Clock_",
    .hash = EPG_TYPE_HASH("RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"),
    .write = write_clock,
};
