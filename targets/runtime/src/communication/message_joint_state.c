/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * sensor_msgs/msg/JointState: header, names, positions, velocities, efforts.
 */
#include "epg/message.h"

#include <math.h>
#include <string.h>

#include "message_layout.h"

enum { QUANTITIES = 3 }; /* positions, velocities, efforts */

/** Returns true if a value of `topic` belongs to `quantity`. */
static bool has(const epg_topic_t *topic, size_t quantity)
{
    const epg_message_layout_t *layout = topic->layout;
    for (size_t i = 0; i < topic->count; i++) {
        if (layout->fields[i] % QUANTITIES == quantity) {
            return true;
        }
    }
    return false;
}

static void write_quantity(epg_cdr_writer_t *writer, const epg_topic_t *topic, const double *values, size_t quantity)
{
    epg_layout_walk_t walk = epg_layout_walk(topic, values);
    const size_t joints = has(topic, quantity) ? walk.layout->count : 0;
    epg_cdr_write_u32(writer, (uint32_t)joints);
    for (size_t i = 0; i < joints; i++) {
        epg_cdr_write_f64(writer, epg_layout_value(&walk, i * QUANTITIES + quantity, (double)NAN));
    }
}

static size_t write_joint_state(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data,
                                size_t size)
{
    const epg_message_layout_t *layout = topic->layout;
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_write_header(&writer, stamp, layout->frame_id);
    epg_cdr_write_u32(&writer, (uint32_t)layout->count);
    for (size_t i = 0; i < layout->count; i++) {
        epg_cdr_write_string(&writer, layout->names[i]);
    }
    for (size_t quantity = 0; quantity < QUANTITIES; quantity++) {
        write_quantity(&writer, topic, values, quantity);
    }
    return writer.failed ? 0 : writer.length;
}

/** Reads the names, and sets the places of the layout's joints among them; SIZE_MAX for a joint that is missing. */
static void read_names(epg_cdr_reader_t *reader, const epg_message_layout_t *layout, size_t *places)
{
    const size_t count = epg_cdr_read_u32(reader);
    for (size_t i = 0; i < layout->count; i++) {
        places[i] = SIZE_MAX;
    }
    for (size_t place = 0; place < count && !reader->failed; place++) {
        const char *name = epg_cdr_read_string(reader);
        for (size_t i = 0; i < layout->count && name != NULL; i++) {
            if (places[i] == SIZE_MAX && strcmp(name, layout->names[i]) == 0) {
                places[i] = place;
            }
        }
    }
}

/** Reads the values of a quantity.  Returns false if one is missing. */
static bool read_quantity(epg_cdr_reader_t *reader, const epg_topic_t *topic, size_t quantity, const size_t *places,
                          double *values)
{
    const epg_message_layout_t *layout = topic->layout;
    size_t first;
    const size_t count = epg_cdr_read_sequence(reader, sizeof(double), &first);
    epg_cdr_reader_t number = *reader;
    for (size_t i = 0; i < topic->count; i++) {
        const size_t place = places[layout->fields[i] / QUANTITIES];
        if (layout->fields[i] % QUANTITIES != quantity) {
            continue;
        }
        if (place >= count) {
            return false;
        }
        number.position = first + place * sizeof(double);
        values[i] = epg_cdr_read_f64(&number);
    }
    return !reader->failed;
}

static bool read_joint_state(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    const epg_message_layout_t *layout = topic->layout;
    size_t places[EPG_MESSAGE_ELEMENTS];
    epg_cdr_reader_t reader = {.data = data, .size = size};
    if (layout->count > EPG_MESSAGE_ELEMENTS) {
        return false;
    }
    epg_skip_header(&reader);
    read_names(&reader, layout, places);
    for (size_t quantity = 0; quantity < QUANTITIES; quantity++) {
        if (!read_quantity(&reader, topic, quantity, places, values)) {
            return false;
        }
    }
    return true;
}

const epg_message_t epg_message_joint_state = {
    .type = "sensor_msgs::msg::dds_::JointState_",
    .hash = EPG_TYPE_HASH("RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"),
    .write = write_joint_state,
    .read = read_joint_state,
    .stamped = true,
};
