/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The variables of a model are kept and restored; the bytes around a region stay as they are.
 */
#include "epg/variables.h"

#include <string.h>

#include "check.h"

enum { SIZE = 64, EDGE = 16 };

static union {
    uint32_t aligned;
    unsigned char bytes[SIZE];
} section;

/** Fills the section with different bytes, none of which is 0. */
static void fill(unsigned char first)
{
    for (unsigned char i = 0; i < SIZE; i++) {
        section.bytes[i] = (unsigned char)(first + i);
    }
}

/** Every start and every size: only the bytes of the region change, and they become `zero` or those that were kept. */
static void try_regions(bool zero)
{
    for (uint32_t offset = 0; offset < EDGE; offset++) {
        for (uint32_t size = 0; offset + size <= SIZE; size++) {
            uint32_t kept[SIZE / sizeof(uint32_t) + 1U];
            const epg_region_t region = {.section = section.bytes, .offset = offset, .size = size, .zero = zero};
            const epg_variables_t variables = {.regions = &region, .count = 1, .kept = kept};

            memset(kept, 0xEE, sizeof kept);
            fill(1);
            epg_variables_keep(&variables);
            CHECK_EQUAL(kept[(size + 3U) / 4U], 0xEEEEEEEEU);
            fill(101);
            epg_variables_restore(&variables);
            for (uint32_t i = 0; i < SIZE; i++) {
                const bool inside = i >= offset && i < offset + size;
                CHECK_EQUAL(section.bytes[i], inside ? (zero ? 0U : 1U + i) : 101U + i);
            }
        }
    }
}

TEST(only_the_region_is_cleared)
{
    try_regions(true);
}

TEST(only_the_region_gets_the_kept_bytes)
{
    try_regions(false);
}

TEST(regions_have_separate_memory_and_missing_ones_are_left_out)
{
    uint32_t kept[3];
    const epg_region_t regions[] = {
        {.section = section.bytes, .offset = 1, .size = 3},
        {.section = NULL, .offset = 8, .size = 400},
        {.section = section.bytes, .offset = 8, .size = 4, .zero = true},
        {.section = section.bytes, .offset = 16, .size = 5},
    };
    const epg_variables_t variables = {.regions = regions, .count = 4, .kept = kept};

    fill(1);
    epg_variables_keep(&variables);
    for (int turn = 0; turn < 2; turn++) {
        fill(101);
        epg_variables_restore(&variables);
        CHECK_EQUAL(section.bytes[0], 101);
        CHECK_EQUAL(section.bytes[3], 4);
        CHECK_EQUAL(section.bytes[4], 105);
        CHECK_EQUAL(section.bytes[8], 0);
        CHECK_EQUAL(section.bytes[11], 0);
        CHECK_EQUAL(section.bytes[16], 17);
        CHECK_EQUAL(section.bytes[20], 21);
        CHECK_EQUAL(section.bytes[21], 122);
    }
}

TEST(a_model_without_variables)
{
    const epg_variables_t variables = {.count = 0};

    epg_variables_keep(&variables);
    epg_variables_restore(&variables);
    CHECK_EQUAL(epg_variables_no_destructor(), 0);
}

RUN()
