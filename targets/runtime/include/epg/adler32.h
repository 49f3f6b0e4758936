/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The checksum Adler-32 (RFC 1950, section 8.2).  It detects a record in flash that was only partly programmed.
 */
#ifndef EPG_ADLER32_H
#define EPG_ADLER32_H

#include <stddef.h>
#include <stdint.h>

/** Continues the checksum `sum` with `size` bytes.  The first call must pass 1. */
static inline uint32_t epg_adler32(uint32_t sum, const void *data, size_t size)
{
    const uint8_t *bytes = data;
    uint32_t first = sum & 0xFFFFU;
    uint32_t second = sum >> 16;
    for (size_t i = 0; i < size; i++) {
        first = (first + bytes[i]) % 65521U;
        second = (second + first) % 65521U;
    }
    return second << 16 | first;
}

#endif
