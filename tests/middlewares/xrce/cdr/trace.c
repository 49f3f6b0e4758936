/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Writes and reads random numbers in both byte orders by Micro-CDR, through two small buffers, and prints all that a
 * caller can see.
 *
 * It is linked with Micro-CDR's functions for numbers and with those of the middleware: both must print the same.  With
 * two buffers it uses the byte order of this computer only: for the other one, Micro-CDR 2.0.1 accesses memory beyond
 * the first buffer.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <ucdr/microcdr.h>

enum { SIZE = 32, RUNS = 4000, OPERATIONS = 12, KINDS = 24 };

static uint8_t first[SIZE], second[SIZE];
static uint64_t state = 1;

static uint64_t random_bits(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return state >> 16 ^ state << 40;
}

/** Continues in the second buffer, once. */
static bool on_full(ucdrBuffer *buffer, void *size)
{
    if (buffer->init == second) {
        return true;
    }
    buffer->init = buffer->iterator = second;
    buffer->final = second + *(size_t *)size;
    return false;
}

#define CASES(number, suffix, type)                                                                                    \
    case 2 * number: {                                                                                                 \
        type value;                                                                                                    \
        memcpy(&value, &bits, sizeof value);                                                                           \
        return write ? ucdr_serialize##suffix(buffer, value) : ucdr_deserialize##suffix(buffer, (void *)result);       \
    }                                                                                                                  \
    case 2 * number + 1: {                                                                                             \
        type value;                                                                                                    \
        memcpy(&value, &bits, sizeof value);                                                                           \
        return write ? ucdr_serialize_endian##suffix(buffer, order, value)                                             \
                     : ucdr_deserialize_endian##suffix(buffer, order, (void *)result);                                 \
    }

static bool operate(ucdrBuffer *buffer, bool write, unsigned int kind, ucdrEndianness order, uint64_t bits,
                    uint64_t *result)
{
    switch (kind) {
        CASES(0, _char, char)
        CASES(1, _uint8_t, uint8_t)
        CASES(2, _uint16_t, uint16_t)
        CASES(3, _uint32_t, uint32_t)
        CASES(4, _uint64_t, uint64_t)
        CASES(5, _int8_t, int8_t)
        CASES(6, _int16_t, int16_t)
        CASES(7, _int32_t, int32_t)
        CASES(8, _int64_t, int64_t)
        CASES(9, _float, float)
        CASES(10, _double, double)
    case 22:
        return write ? ucdr_serialize_bool(buffer, bits & 1u) : ucdr_deserialize_bool(buffer, (void *)result);
    default:
        return write ? ucdr_serialize_endian_bool(buffer, order, bits & 1u)
                     : ucdr_deserialize_endian_bool(buffer, order, (void *)result);
    }
}

static void run(bool write)
{
    ucdrBuffer buffer;
    size_t rest = 8 + random_bits() % (SIZE - 8);
    for (size_t i = 0; i < SIZE; i++) {
        first[i] = write ? 0 : (uint8_t)random_bits();
        second[i] = write ? 0 : (uint8_t)random_bits();
    }
    const bool two = random_bits() & 1u;
    ucdr_init_buffer_origin_offset_endian(&buffer, first, random_bits() % SIZE, random_bits() % 8, 0,
                                          two ? UCDR_MACHINE_ENDIANNESS : (ucdrEndianness)(random_bits() & 1u));
    if (two) {
        ucdr_set_on_full_buffer_callback(&buffer, on_full, &rest);
    }
    for (int i = 0; i < OPERATIONS && !buffer.error; i++) {
        uint64_t result = 0;
        const unsigned int kind = (unsigned int)(random_bits() % KINDS);
        const ucdrEndianness order = two ? UCDR_MACHINE_ENDIANNESS : (ucdrEndianness)(random_bits() & 1u);
        const bool good = operate(&buffer, write, kind, order, random_bits(), &result);
        printf("%u %d %d %zu", kind, good, buffer.error, buffer.offset);
        if (good) { /* after an error, the place in the buffer and the value have no meaning */
            printf(" %u %td %" PRIx64, buffer.last_data_size, buffer.iterator - buffer.init, result);
        }
        printf("\n");
    }
    for (size_t i = 0; i < SIZE && !buffer.error; i++) {
        printf("%02x%02x", first[i], second[i]);
    }
    printf("\n");
}

int main(void)
{
    for (int i = 0; i < RUNS; i++) {
        run(i % 2 == 0);
    }
    return 0;
}
