/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Keeps and restores the variables of a model.
 *
 * It copies by loops of its own: memcpy() can be in flash, and AddressSanitizer's memcpy() refuses the space that it has
 * put between variables.
 */
#include "epg/variables.h"

#ifdef __GNUC__
#define MAY_ALIAS __attribute__((may_alias))
#define NOT_SANITIZED __attribute__((no_sanitize_address))
#else
#define MAY_ALIAS
#define NOT_SANITIZED
#endif

/* Volatile, so that the compiler does not replace a loop by a call of memcpy() or memset(). */
typedef volatile uint32_t MAY_ALIAS word_t;
typedef volatile unsigned char byte_t;

static bool is_aligned(const void *address)
{
    return (uintptr_t)address % sizeof(uint32_t) == 0U;
}

/** Copies `size` bytes.  One of the two addresses is that of a word. */
NOT_SANITIZED static void copy(unsigned char *to, const unsigned char *from, uint32_t size)
{
    uint32_t done = 0;
    if (is_aligned(to) && is_aligned(from)) {
        for (; size - done >= sizeof(uint32_t); done += (uint32_t)sizeof(uint32_t)) {
            *(word_t *)(void *)(to + done) = *(const word_t *)(const void *)(from + done);
        }
    }
    for (; done < size; done++) {
        *(byte_t *)(to + done) = from[done];
    }
}

NOT_SANITIZED static void clear(unsigned char *to, uint32_t size)
{
    uint32_t done = 0;
    for (; done < size && !is_aligned(to + done); done++) {
        *(byte_t *)(to + done) = 0U;
    }
    for (; size - done >= sizeof(uint32_t); done += (uint32_t)sizeof(uint32_t)) {
        *(word_t *)(void *)(to + done) = 0U;
    }
    for (; done < size; done++) {
        *(byte_t *)(to + done) = 0U;
    }
}

/** The words that hold `size` bytes. */
static size_t words(uint32_t size)
{
    return (size + sizeof(uint32_t) - 1U) / sizeof(uint32_t);
}

void epg_variables_keep(const epg_variables_t *variables)
{
    uint32_t *kept = variables->kept;
    for (size_t i = 0; i < variables->count; i++) {
        const epg_region_t *region = &variables->regions[i];
        if (region->section != NULL && !region->zero) {
            copy((unsigned char *)kept, region->section + region->offset, region->size);
            kept += words(region->size);
        }
    }
}

void epg_variables_restore(const epg_variables_t *variables)
{
    const uint32_t *kept = variables->kept;
    for (size_t i = 0; i < variables->count; i++) {
        const epg_region_t *region = &variables->regions[i];
        if (region->section == NULL) {
            continue;
        }
        if (region->zero) {
            clear(region->section + region->offset, region->size);
        } else {
            copy(region->section + region->offset, (const unsigned char *)kept, region->size);
            kept += words(region->size);
        }
    }
}

int epg_variables_no_destructor(void)
{
    return 0;
}
