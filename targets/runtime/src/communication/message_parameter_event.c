/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * rcl_interfaces/msg/ParameterEvent: a stamp, the name of the node, and three sequences of parameters: new, changed and
 * deleted ones.  Only the second one is ever filled.
 */
#include <string.h>

#include "epg/cdr.h"
#include "parameter_request.h"

enum { DELETED = 8 /* bytes of the empty sequence at the end, with its padding */ };

/**
 * Takes the changes of the last message out of the list of news.  If it could not be sent, they are news again.
 * Returns true if there are news.
 */
static bool refresh(const epg_parameters_t *parameters, bool unsent)
{
    bool any = false;
    for (size_t i = 0; i < parameters->count; i++) {
        if (parameters->news[i] == EPG_PARAMETER_TELLING) {
            parameters->news[i] = unsent ? EPG_PARAMETER_NEW : EPG_PARAMETER_TOLD;
        }
        any = any || parameters->news[i] == EPG_PARAMETER_NEW;
    }
    return any;
}

static void write_parameter(epg_cdr_writer_t *writer, const char *name, double value)
{
    epg_cdr_write_string(writer, name);
    epg_cdr_write_u8(writer, EPG_PARAMETER_TYPE_DOUBLE);
    epg_cdr_write_u8(writer, 0);    /* bool_value */
    epg_cdr_write_f64(writer, 0.0); /* integer_value: as the integer 0 */
    epg_cdr_write_f64(writer, value);
    epg_cdr_write_string(writer, ""); /* string_value */
    for (size_t i = 0; i < 5; i++) {
        epg_cdr_write_u32(writer, 0); /* the arrays of bytes, booleans, integers, doubles and strings */
    }
}

/** Writes the news that fit.  Returns their number. */
static uint32_t write_news(epg_cdr_writer_t *writer, const epg_node_t *node, const epg_parameters_t *parameters)
{
    uint32_t count = 0;
    for (size_t i = 0; i < parameters->count; i++) {
        const size_t before = writer->length;
        if (parameters->news[i] != EPG_PARAMETER_NEW) {
            continue;
        }
        write_parameter(writer, node->target->service_state->texts[i].name, parameters->values[i]);
        if (writer->failed) {
            writer->length = before;
            writer->failed = false;
            break;
        }
        parameters->news[i] = EPG_PARAMETER_TELLING;
        count++;
    }
    return count;
}

static size_t write_event(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data, size_t size)
{
    const epg_parameter_event_t *event = topic->layout;
    epg_parameters_t *parameters = epg_parameters_of(event->node);
    const epg_topic_t node = {.name = "~"};
    char name[EPG_NODE_TOPIC_SIZE];
    (void)values;
    if (!refresh(parameters, event->publication->waiting) || !epg_parameters_idle(parameters) || size < DELETED) {
        return 0;
    }
    (void)epg_node_topic(event->node, &node, name, sizeof name);
    epg_cdr_writer_t writer = {.data = data, .size = size - DELETED};
    epg_cdr_write_i32(&writer, stamp.seconds);
    epg_cdr_write_u32(&writer, stamp.nanoseconds);
    epg_cdr_write_string(&writer, name);
    epg_cdr_write_u32(&writer, 0); /* new_parameters */
    epg_cdr_write_u32(&writer, 0); /* changed_parameters: their number follows below */
    if (writer.failed) {
        return 0;
    }
    const size_t start = writer.length - sizeof(uint32_t);
    epg_cdr_writer_t number = {.data = data, .size = size, .length = start};
    epg_cdr_write_u32(&number, write_news(&writer, event->node, parameters));
    writer.size = size;
    epg_cdr_write_u32(&writer, 0); /* deleted_parameters */
    return writer.length;
}

const epg_message_t epg_message_parameter_event = {
    .type = "rcl_interfaces::msg::dds_::ParameterEvent_",
    .hash = EPG_TYPE_HASH("RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"),
    .write = write_event,
    .stamped = true,
};
