/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Messages of any type, described by tables: see epg_message_table_t.
 */
#include "epg/cdr.h"
#include "epg/message.h"
#include "epg/target.h"

#include <string.h>

static const uint8_t SIZES[] = {
    [EPG_FIELD_BOOL] = 1,   [EPG_FIELD_INT8] = 1,    [EPG_FIELD_UINT8] = 1,   [EPG_FIELD_INT16] = 2,
    [EPG_FIELD_UINT16] = 2, [EPG_FIELD_INT32] = 4,   [EPG_FIELD_UINT32] = 4,  [EPG_FIELD_INT64] = 8,
    [EPG_FIELD_UINT64] = 8, [EPG_FIELD_FLOAT32] = 4, [EPG_FIELD_FLOAT64] = 8,
};

/** Returns true if `type` is a signed whole number. */
static bool is_signed(uint8_t type)
{
    return type == EPG_FIELD_INT8 || type == EPG_FIELD_INT16 || type == EPG_FIELD_INT32 || type == EPG_FIELD_INT64;
}

/** Returns the table of the topic's message, which is its first member. */
static const epg_message_table_t *table_of(const epg_topic_t *topic)
{
    return (const epg_message_table_t *)(const void *)topic->message;
}

/**
 * Returns the bits of the nearest whole number, limited to the range of `type`.  Halves are rounded away from zero, and
 * NaN is 0.
 */
static uint64_t whole_bits(uint8_t type, double value)
{
    const unsigned width = 8U * SIZES[type] - (is_signed(type) ? 1U : 0U);
    const uint64_t most = UINT64_MAX >> (64U - width);
    const double above = (double)(UINT64_C(1) << (width - 1)) * 2.0; /* most + 1, which a double represents exactly */
    if (!(value == value)) {
        return 0;
    }
    const double moved = value < 0.0 ? value - 0.5 : value + 0.5;
    if (moved >= above) {
        return most;
    }
    if (!is_signed(type)) {
        return moved <= 0.0 ? 0 : (uint64_t)moved;
    }
    return moved <= -above ? ~most : (uint64_t)(int64_t)moved;
}

static uint64_t bits_of(uint8_t type, double value)
{
    uint64_t bits = 0;
    if (type == EPG_FIELD_FLOAT64) {
        memcpy(&bits, &value, sizeof value);
    } else if (type == EPG_FIELD_FLOAT32) {
        const float narrow = (float)value;
        uint32_t half;
        memcpy(&half, &narrow, sizeof half);
        bits = half;
    } else if (type == EPG_FIELD_BOOL) {
        bits = value > 0.5 ? 1 : 0;
    } else {
        bits = whole_bits(type, value);
    }
    return bits;
}

static void put(unsigned char *place, size_t size, uint64_t bits)
{
    for (size_t i = 0; i < size; i++) {
        place[i] = (unsigned char)(bits >> (8 * i));
    }
}

size_t epg_message_table_write(const epg_topic_t *topic, const double *values, epg_stamp_t stamp, void *data,
                               size_t size)
{
    const epg_message_table_t *table = table_of(topic);
    unsigned char *message = data;
    if (size < table->size) {
        return 0;
    }
    memcpy(message, table->data, table->size);
    for (size_t i = 0; i < table->place_count; i++) {
        const epg_message_place_t *place = &table->places[i];
        if (place->type == EPG_FIELD_STAMP) {
            put(message + place->offset, 4, (uint32_t)stamp.seconds);
            put(message + place->offset + 4, 4, stamp.nanoseconds);
        } else {
            put(message + place->offset, SIZES[place->type], bits_of(place->type, values[i]));
        }
    }
    return table->size;
}

/** Returns the number with these bits; `*good` becomes false for a Boolean value other than 0 and 1. */
static double number_of(uint8_t type, uint64_t bits, bool *good)
{
    if (type == EPG_FIELD_FLOAT64) {
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    if (type == EPG_FIELD_FLOAT32) {
        const uint32_t half = (uint32_t)bits;
        float value;
        memcpy(&value, &half, sizeof value);
        return (double)value;
    }
    if (type == EPG_FIELD_BOOL && bits > 1) {
        *good = false;
    }
    const unsigned width = 8U * SIZES[type];
    if (is_signed(type) && (bits >> (width - 1)) != 0) {
        const uint64_t magnitude = (~bits & (UINT64_MAX >> (64U - width))) + 1U; /* two's complement */
        return -(double)magnitude;
    }
    return (double)bits;
}

static void skip_texts(epg_cdr_reader_t *reader, uint32_t count)
{
    for (uint32_t i = 0; i < count && !reader->failed; i++) {
        (void)epg_cdr_read_string(reader);
    }
}

bool epg_message_table_read(const epg_topic_t *topic, const void *data, size_t size, double *values)
{
    const epg_message_table_t *table = table_of(topic);
    epg_cdr_reader_t reader = {.data = data, .size = size};
    bool good = true;
    for (size_t i = 0; i < table->step_count && !reader.failed; i++) {
        const epg_message_step_t *step = &table->steps[i];
        if (step->type == EPG_FIELD_STRING) {
            skip_texts(&reader, step->sequence ? epg_cdr_read_u32(&reader) : step->count);
        } else if (step->sequence) {
            size_t first;
            (void)epg_cdr_read_sequence(&reader, SIZES[step->type], &first);
        } else if (step->value == EPG_STEP_SKIP) {
            epg_cdr_skip(&reader, SIZES[step->type], step->count);
        } else {
            values[step->value] = number_of(step->type, epg_cdr_read_bits(&reader, SIZES[step->type]), &good);
        }
    }
    return good && !reader.failed;
}
