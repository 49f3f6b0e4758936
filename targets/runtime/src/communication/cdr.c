/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Common Data Representation.
 */
#include "epg/cdr.h"

#include <string.h>

/**
 * Returns the place for a number of `size` bytes, after padding with zeros to its alignment; NULL if it does not fit.
 */
static unsigned char *reserve(epg_cdr_writer_t *writer, size_t size, size_t alignment)
{
    const size_t start = (writer->length + alignment - 1) / alignment * alignment;
    if (writer->failed || start > writer->size || size > writer->size - start) {
        writer->failed = true;
        return NULL;
    }
    memset(writer->data + writer->length, 0, start - writer->length);
    writer->length = start + size;
    return writer->data + start;
}

/** Returns the place of the next number to read; NULL if the message is too short. */
static const unsigned char *take(epg_cdr_reader_t *reader, size_t size, size_t alignment)
{
    const size_t start = (reader->position + alignment - 1) / alignment * alignment;
    if (reader->failed || start > reader->size || size > reader->size - start) {
        reader->failed = true;
        return NULL;
    }
    reader->position = start + size;
    return reader->data + start;
}

static void write_bits(epg_cdr_writer_t *writer, uint64_t bits, size_t size)
{
    unsigned char *place = reserve(writer, size, size);
    for (size_t i = 0; place != NULL && i < size; i++) {
        place[i] = (unsigned char)(bits >> (8 * i));
    }
}

uint64_t epg_cdr_read_bits(epg_cdr_reader_t *reader, size_t size)
{
    const unsigned char *place = take(reader, size, size);
    uint64_t bits = 0;
    for (size_t i = 0; place != NULL && i < size; i++) {
        bits |= (uint64_t)place[i] << (8 * i);
    }
    return bits;
}

void epg_cdr_write_u8(epg_cdr_writer_t *writer, uint8_t value)
{
    write_bits(writer, value, sizeof value);
}

void epg_cdr_write_u32(epg_cdr_writer_t *writer, uint32_t value)
{
    write_bits(writer, value, sizeof value);
}

void epg_cdr_write_i32(epg_cdr_writer_t *writer, int32_t value)
{
    write_bits(writer, (uint32_t)value, sizeof value);
}

void epg_cdr_write_f32(epg_cdr_writer_t *writer, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    write_bits(writer, bits, sizeof bits);
}

void epg_cdr_write_f64(epg_cdr_writer_t *writer, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    write_bits(writer, bits, sizeof bits);
}

void epg_cdr_write_string(epg_cdr_writer_t *writer, const char *text)
{
    const size_t size = strlen(text) + 1;
    epg_cdr_write_u32(writer, (uint32_t)size);
    unsigned char *place = reserve(writer, size, 1);
    if (place != NULL) {
        memcpy(place, text, size);
    }
}

uint8_t epg_cdr_read_u8(epg_cdr_reader_t *reader)
{
    return (uint8_t)epg_cdr_read_bits(reader, sizeof(uint8_t));
}

uint32_t epg_cdr_read_u32(epg_cdr_reader_t *reader)
{
    return (uint32_t)epg_cdr_read_bits(reader, sizeof(uint32_t));
}

int32_t epg_cdr_read_i32(epg_cdr_reader_t *reader)
{
    const uint32_t bits = (uint32_t)epg_cdr_read_bits(reader, sizeof bits);
    int32_t value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

float epg_cdr_read_f32(epg_cdr_reader_t *reader)
{
    const uint32_t bits = (uint32_t)epg_cdr_read_bits(reader, sizeof bits);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

double epg_cdr_read_f64(epg_cdr_reader_t *reader)
{
    const uint64_t bits = epg_cdr_read_bits(reader, sizeof bits);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

void epg_cdr_skip(epg_cdr_reader_t *reader, size_t size, uint16_t count)
{
    if (count > 0) {
        (void)take(reader, size * count, size);
    }
}

size_t epg_cdr_read_sequence(epg_cdr_reader_t *reader, size_t size, size_t *first)
{
    const size_t count = epg_cdr_read_u32(reader);
    const size_t start = (reader->position + size - 1) / size * size;
    *first = start;
    if (count == 0 || reader->failed) {
        return 0; /* an empty sequence has no padding to the alignment of its elements */
    }
    if (start > reader->size || count > (reader->size - start) / size) {
        reader->failed = true;
        return 0;
    }
    reader->position = start + count * size;
    return count;
}

const char *epg_cdr_read_string(epg_cdr_reader_t *reader)
{
    const uint32_t size = epg_cdr_read_u32(reader);
    const unsigned char *place = size > 0 ? take(reader, size, 1) : NULL;
    if (place == NULL || place[size - 1] != '\0') {
        reader->failed = true;
        return NULL;
    }
    return (const char *)place;
}
