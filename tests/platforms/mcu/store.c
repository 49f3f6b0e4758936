/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The store's records on a family whose two sectors are arrays: power failures, unreadable sectors, refused requests.
 */
#include <stdio.h>
#include <string.h>

#include "epg/port.h"
#include "epg/sectors.h"
#include "epg/ticks.h"

#define CAPACITY 96U
#define SECTOR (CAPACITY + 16U)

static uint8_t sectors[2][SECTOR];
static bool readable[2];
static int steps; /* number of bytes that can be programmed until the supply fails */
static bool permitted;

static void require(bool good, int line)
{
    if (!good) {
        (void)printf("line %d\n", line);
        __builtin_trap();
    }
}
#define REQUIRE(condition) require(condition, __LINE__)

size_t epg_sectors_capacity(void)
{
    return CAPACITY;
}

bool epg_sectors_read(uint32_t index, size_t at, void *data, size_t size)
{
    REQUIRE(at + size <= SECTOR);
    memcpy(data, sectors[index] + at, size);
    return readable[index];
}

static bool program(uint8_t *to, const uint8_t *from, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        if (steps-- <= 0) {
            return false;
        }
        REQUIRE(to[i] == 0xFF); /* no byte is programmed twice */
        to[i] = from[i];
    }
    return true;
}

bool epg_sectors_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size)
{
    if (!permitted) {
        return false;
    }
    REQUIRE(size <= CAPACITY && head_size <= 16U);
    memset(sectors[index], 0xFF, SECTOR);
    readable[index] = true;
    return program(sectors[index], data, size) && program(sectors[index] + CAPACITY, head, head_size);
}

static void begin(void)
{
    memset(sectors, 0xFF, sizeof sectors);
    readable[0] = readable[1] = permitted = true;
    steps = 1000;
}

static bool stored(const char *text)
{
    char found[64] = {0};
    return epg_port_store_read(found, sizeof found) == strlen(text) && strcmp(found, text) == 0;
}

static bool write_text(const char *text)
{
    return epg_port_store_write(text, strlen(text)) == NULL;
}

static void newest_counts(void)
{
    begin();
    REQUIRE(stored(""));
    REQUIRE(write_text("first") && stored("first"));
    REQUIRE(write_text("second") && stored("second"));
    REQUIRE(write_text("third") && stored("third"));
    readable[0] = false; /* like an ECC error: the third record is still readable */
    REQUIRE(stored("second"));
    readable[0] = true;
    readable[1] = false;
    REQUIRE(stored("third"));
    readable[0] = false;
    REQUIRE(stored(""));
    REQUIRE(write_text("again") && stored("again"));
}

static void power_cut(void)
{
    for (int cut = 0; cut < 6 + 16; cut++) {
        begin();
        REQUIRE(write_text("old one"));
        steps = cut;
        REQUIRE(!write_text("newest"));
        REQUIRE(stored("old one"));
        steps = 1000;
        REQUIRE(write_text("after") && stored("after"));
    }
}

static void refusals(void)
{
    char large[CAPACITY + 1U] = {0};
    begin();
    REQUIRE(write_text("kept"));
    REQUIRE(epg_port_store_write(large, sizeof large) != NULL);
    permitted = false;
    REQUIRE(!write_text("lost") && stored("kept"));
}

static void ticks(void)
{
    epg_mcu_ticks_t clock = {.due_ns = 5000000, .period_ns = 1000000};
    REQUIRE(epg_mcu_ticks_pass(&clock, 6000000 - 900, 1000) == 1 && clock.due_ns == 6000000);
    REQUIRE(epg_mcu_ticks_pass(&clock, 6000900, 1000) == 0 && clock.due_ns == 6000000);
    REQUIRE(epg_mcu_ticks_pass(&clock, 7700000, 1000) == 1 && clock.due_ns == 7000000);
    REQUIRE(epg_mcu_ticks_pass(&clock, 10200000, 1000) == 3 && clock.due_ns == 10000000);
}

int main(void)
{
    newest_counts();
    power_cut();
    refusals();
    ticks();
    return 0;
}
