/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Requests that concern parameters.
 */
#include "parameter_request.h"

#include <string.h>

/** Skips a sequence of texts. */
static void skip_strings(epg_cdr_reader_t *reader)
{
    const uint32_t count = epg_cdr_read_u32(reader);
    for (uint32_t i = 0; i < count && !reader->failed; i++) {
        (void)epg_cdr_read_string(reader);
    }
}

/** Reads a rcl_interfaces/msg/ParameterValue. */
static void read_value(epg_cdr_reader_t *reader, epg_parameter_entry_t *entry)
{
    size_t first;
    entry->type = epg_cdr_read_u8(reader);
    (void)epg_cdr_read_u8(reader); /* bool_value */
    const int64_t integer = (int64_t)epg_cdr_read_bits(reader, sizeof integer);
    const double number = epg_cdr_read_f64(reader);
    entry->value = entry->type == EPG_PARAMETER_TYPE_INTEGER ? (double)integer : number;
    (void)epg_cdr_read_string(reader);
    (void)epg_cdr_read_sequence(reader, sizeof(uint8_t), &first);  /* byte_array_value */
    (void)epg_cdr_read_sequence(reader, sizeof(uint8_t), &first);  /* bool_array_value */
    (void)epg_cdr_read_sequence(reader, sizeof(uint64_t), &first); /* integer_array_value */
    (void)epg_cdr_read_sequence(reader, sizeof(double), &first);   /* double_array_value */
    skip_strings(reader);
}

static epg_parameter_entry_t read_entry(epg_cdr_reader_t *reader, bool values)
{
    epg_parameter_entry_t entry = {.name = epg_cdr_read_string(reader), .index = SIZE_MAX};
    if (values) {
        read_value(reader, &entry);
    }
    return entry;
}

/** Returns the index of the parameter `name`, or SIZE_MAX.  Looks at `guess` first, then at those after it. */
static size_t find(const epg_node_t *node, const char *name, size_t guess)
{
    const epg_parameter_text_t *texts = node->target->service_state->texts;
    const size_t count = epg_parameters_of(node)->count;
    for (size_t i = 0; i < count; i++) {
        const size_t index = (guess + i) % count;
        if (strcmp(texts[index].name, name) == 0) {
            return index;
        }
    }
    return SIZE_MAX;
}

bool epg_parameter_entries_check(epg_node_t *node, epg_cdr_reader_t *request, bool values)
{
    epg_service_state_t *state = node->target->service_state;
    const uint32_t count = epg_cdr_read_u32(request);
    for (uint32_t i = 0; i < count && !request->failed; i++) {
        (void)read_entry(request, values);
    }
    state->entries = count;
    state->entry = 0;
    state->entry_position = sizeof count;
    return !request->failed;
}

epg_parameter_entry_t epg_parameter_entry_read(epg_node_t *node, size_t number, bool values)
{
    epg_service_state_t *state = node->target->service_state;
    if (number < state->entry) {
        state->entry = 0;
        state->entry_position = sizeof(uint32_t);
    }
    epg_cdr_reader_t reader = {.data = state->request, .size = state->length, .position = state->entry_position};
    epg_parameter_entry_t entry = {.name = "", .index = SIZE_MAX};
    for (; state->entry <= number; state->entry++) {
        entry = read_entry(&reader, values);
    }
    state->entry_position = reader.position;
    /* Requests name parameters in their order most of the time. */
    entry.index = find(node, entry.name, number);
    return entry;
}

void epg_parameter_write_value(epg_reply_t *reply, double value)
{
    epg_reply_u8(reply, EPG_PARAMETER_TYPE_DOUBLE);
    epg_reply_u8(reply, 0);  /* bool_value */
    epg_reply_u64(reply, 0); /* integer_value */
    epg_reply_f64(reply, value);
    epg_reply_string(reply, ""); /* string_value */
    for (size_t i = 0; i < 5; i++) {
        epg_reply_u32(reply, 0); /* the arrays of bytes, booleans, integers, doubles and strings */
    }
}
