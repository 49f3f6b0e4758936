/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions of Micro-CDR for numbers, in place of its src/c/types/basic.c.
 *
 * Each function of that file has code of its own for both byte orders and for a value that continues in a second buffer.
 * The client needs 20 of them, 2.9 kB for a Cortex-M0+.  These functions share one loop over the bytes of a value.  They
 * give the same results.
 */
#include <ucdr/microcdr.h>

/** Micro-CDR's src/c/common_internal.h declares it: false if the buffer is full and no other one takes its place. */
bool ucdr_check_final_buffer_behavior(ucdrBuffer *buffer, size_t bytes);

/** Aligns the buffer for a value of `size` bytes. */
static void align(ucdrBuffer *buffer, size_t size)
{
    ucdr_advance_buffer(buffer, ucdr_buffer_alignment(buffer, size));
}

/**
 * Moves to the next byte, number `done` of a value, in the next buffer if this one is full.  If there is none, returns
 * to the start of the value and returns false.
 */
static bool has_room(ucdrBuffer *buffer, size_t done)
{
    if (ucdr_check_final_buffer_behavior(buffer, 1)) {
        return true;
    }
    buffer->iterator -= done;
    buffer->offset -= done;
    return false;
}

static void advance(ucdrBuffer *buffer)
{
    buffer->iterator++;
    buffer->offset++;
}

/** Returns the place of byte `i` of a value in the memory of this processor. */
static size_t place(ucdrEndianness order, size_t i, size_t size)
{
    return order == UCDR_MACHINE_ENDIANNESS ? i : size - 1 - i;
}

static bool put(ucdrBuffer *buffer, ucdrEndianness order, const void *value, size_t size)
{
    align(buffer, size);
    for (size_t i = 0; i < size; i++) {
        if (!has_room(buffer, i)) {
            return false;
        }
        *buffer->iterator = ((const uint8_t *)value)[place(order, i, size)];
        advance(buffer);
    }
    buffer->last_data_size = (uint8_t)size;
    return true;
}

static bool take(ucdrBuffer *buffer, ucdrEndianness order, void *value, size_t size)
{
    align(buffer, size);
    for (size_t i = 0; i < size; i++) {
        if (!has_room(buffer, i)) {
            return false;
        }
        ((uint8_t *)value)[place(order, i, size)] = *buffer->iterator;
        advance(buffer);
    }
    buffer->last_data_size = (uint8_t)size;
    return true;
}

#define WRITING(suffix, type)                                                                                          \
    bool ucdr_serialize##suffix(ucdrBuffer *buffer, type value)                                                        \
    {                                                                                                                  \
        return put(buffer, buffer->endianness, &value, sizeof value);                                                  \
    }                                                                                                                  \
    bool ucdr_serialize_endian##suffix(ucdrBuffer *buffer, ucdrEndianness order, type value)                           \
    {                                                                                                                  \
        return put(buffer, order, &value, sizeof value);                                                               \
    }

#define READING(suffix, type)                                                                                          \
    bool ucdr_deserialize##suffix(ucdrBuffer *buffer, type *value)                                                     \
    {                                                                                                                  \
        return take(buffer, buffer->endianness, value, sizeof *value);                                                 \
    }                                                                                                                  \
    bool ucdr_deserialize_endian##suffix(ucdrBuffer *buffer, ucdrEndianness order, type *value)                        \
    {                                                                                                                  \
        return take(buffer, order, value, sizeof *value);                                                              \
    }

#define BOTH(suffix, type) WRITING(suffix, type) READING(suffix, type)

BOTH(_char, char)
BOTH(_uint8_t, uint8_t)
BOTH(_uint16_t, uint16_t)
BOTH(_uint32_t, uint32_t)
BOTH(_uint64_t, uint64_t)
BOTH(_int8_t, int8_t)
BOTH(_int16_t, int16_t)
BOTH(_int32_t, int32_t)
BOTH(_int64_t, int64_t)
BOTH(_float, float)
BOTH(_double, double)
WRITING(_bool, bool)

/** Reads a byte: every value except 0 is true. */
bool ucdr_deserialize_endian_bool(ucdrBuffer *buffer, ucdrEndianness order, bool *value)
{
    uint8_t byte = 0;
    const bool good = take(buffer, order, &byte, sizeof byte);
    if (good) {
        *value = byte != 0;
    }
    return good;
}

bool ucdr_deserialize_bool(ucdrBuffer *buffer, bool *value)
{
    return ucdr_deserialize_endian_bool(buffer, buffer->endianness, value);
}
