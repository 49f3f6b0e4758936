/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * memcpy() and memset() in RAM, for RP2350.
 *
 * The control cycle copies structures, and the compiler turns such copies into calls of these functions.  They must be
 * in RAM.  The SDK's linker scripts try to place the C library's functions there, but find them by the names of
 * archives and members, which differ between toolchains.  On RP2040 the functions are not needed: the SDK brings its
 * own, and puts them in RAM (PICO_MEM_IN_RAM).
 *
 * Both functions are weak: a definition of the user replaces them.
 */
#include <string.h>

#include "epg/pico_sdk.h"

#if !LIB_PICO_MEM_OPS_PICO

/* Without this option the compiler replaces the copying loop in memcpy() by a call of memcpy(). */
#define KEEP_LOOPS __attribute__((weak, optimize("no-tree-loop-distribute-patterns")))

/** A word of memory that may be a part of an object of any type. */
typedef uint32_t __attribute__((may_alias)) word_t;

static inline bool aligned(const void *one, const void *other)
{
    return (((uintptr_t)one | (uintptr_t)other) & 3U) == 0U;
}

void *KEEP_LOOPS __not_in_flash_func(memcpy)(void *restrict to, const void *restrict from, size_t size)
{
    uint8_t *target = to;
    const uint8_t *source = from;
    if (aligned(to, from)) {
        for (; size >= 4U; size -= 4U) {
            *(word_t *)(void *)target = *(const word_t *)(const void *)source;
            target += 4;
            source += 4;
        }
    }
    for (; size > 0U; size--) {
        *target++ = *source++;
    }
    return to;
}

void *KEEP_LOOPS __not_in_flash_func(memset)(void *to, int value, size_t size)
{
    uint8_t *target = to;
    const uint8_t byte = (uint8_t)value;
    for (; size > 0U && !aligned(target, NULL); size--) {
        *target++ = byte;
    }
    const uint32_t word = byte * 0x01010101U;
    for (; size >= 4U; size -= 4U) {
        *(word_t *)(void *)target = word;
        target += 4;
    }
    for (; size > 0U; size--) {
        *target++ = byte;
    }
    return to;
}

#endif
