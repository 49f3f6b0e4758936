/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * memcpy() and memset() in RAM, for the chip whose SDK leaves them to the C library.
 *
 * The control cycle copies structures, and the compiler makes calls of that.  The SDK's linker scripts mean to place the
 * C library's functions in RAM, but know them by names of archive and member that differ between toolchains.  On RP2040
 * the SDK has its own (PICO_MEM_IN_RAM).  Weak: a user's own go first.
 */
#include <string.h>

#include "sdk.h"

#if !LIB_PICO_MEM_OPS_PICO

/* Without this the compiler knows a loop that copies, and calls memcpy(). */
#define KEEP_LOOPS __attribute__((weak, optimize("no-tree-loop-distribute-patterns")))

/** A word of memory of any type. */
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
