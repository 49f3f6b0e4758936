/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A small store in flash: two sectors, of which the one with the higher number counts.
 *
 * A write erases the other sector, programs the bytes, and last the page with number, size and checksum, so that the
 * power may fail at any moment: what is found afterwards is either all new or all old.
 */
#include <string.h>

#include "../../../families/rp2/src/flash.h"
#include "../../../families/rp2/src/parts.h"
#include "epg/adler32.h"
#include "epg/port.h"

/** Bytes from the start of flash.  The last sector is left to others: picotool's mark for RP2350-E10, for one. */
#ifndef EPG_PICO_STORE_OFFSET
#define EPG_PICO_STORE_OFFSET (PICO_FLASH_SIZE_BYTES - 3 * FLASH_SECTOR_SIZE)
#endif

#define MAGIC 0x53475045U /* "EPGS" */
#define SECTORS 2U
/** The head has the last page of a sector. */
#define CAPACITY (FLASH_SECTOR_SIZE - FLASH_PAGE_SIZE)
/** How long core 1 may take to answer: its present cycle. */
#define HOLD_TIMEOUT_MS 300U

typedef struct head {
    uint32_t magic;
    uint32_t number; /* of the write; never 0 */
    uint32_t size;
    uint32_t check; /* of number, size and bytes */
} head_t;

typedef struct job {
    uint32_t offset; /* of the sector */
    const uint8_t *data;
    size_t size;
    head_t head;
} job_t;

/* The end of the image in flash, from the SDK's linker scripts. */
extern char __flash_binary_end;

static const uint8_t *sector(uint32_t index)
{
    return (const uint8_t *)(XIP_BASE + EPG_PICO_STORE_OFFSET + index * FLASH_SECTOR_SIZE);
}

static uint32_t check_of(const head_t *head, const uint8_t *data)
{
    const uint32_t sum =
        epg_adler32(epg_adler32(1U, &head->number, sizeof head->number), &head->size, sizeof head->size);
    return epg_adler32(sum, data, head->size);
}

/** Copies the head of a sector; false if there is none that fits its bytes. */
static bool valid_head(uint32_t index, head_t *head)
{
    memcpy(head, sector(index) + CAPACITY, sizeof *head);
    return head->magic == MAGIC && head->size <= CAPACITY && head->check == check_of(head, sector(index));
}

/** The sector that counts; false when nothing is stored. */
static bool newest(uint32_t *index, head_t *head)
{
    head_t heads[SECTORS];
    const bool valid[SECTORS] = {valid_head(0, &heads[0]), valid_head(1, &heads[1])};
    if (!valid[0] && !valid[1]) {
        return false;
    }
    const bool later = valid[1] && (!valid[0] || (int32_t)(heads[1].number - heads[0].number) > 0);
    *index = later ? 1U : 0U;
    *head = heads[*index];
    return true;
}

/** Programs `size` bytes at `offset`, a multiple of a page, the rest of the last page with ones. */
static void program(uint32_t offset, const uint8_t *data, size_t size)
{
    static uint8_t page[FLASH_PAGE_SIZE];
    for (size_t done = 0; done < size; done += FLASH_PAGE_SIZE) {
        const size_t part = size - done < FLASH_PAGE_SIZE ? size - done : FLASH_PAGE_SIZE;
        memset(page, 0xFF, sizeof page);
        memcpy(page, data + done, part);
        flash_range_program(offset + (uint32_t)done, page, FLASH_PAGE_SIZE);
    }
}

static void run(void *argument)
{
    const job_t *job = argument;
    flash_range_erase(job->offset, FLASH_SECTOR_SIZE);
    program(job->offset, job->data, job->size);
    program(job->offset + CAPACITY, (const uint8_t *)&job->head, sizeof job->head);
}

size_t epg_port_store_read(void *data, size_t size)
{
    uint32_t index;
    head_t head;
    if (!newest(&index, &head)) {
        return 0;
    }
    const size_t count = head.size < size ? head.size : size;
    memcpy(data, sector(index), count);
    return count;
}

bool epg_port_store_write(const void *data, size_t size)
{
    const bool in_image = (uintptr_t)&__flash_binary_end > (uintptr_t)sector(0);
    if (size > CAPACITY || in_image) {
        return false;
    }
    uint32_t index = 1U;
    head_t head = {0};
    (void)newest(&index, &head);
    const uint32_t other = 1U - index;
    job_t job = {
        .offset = EPG_PICO_STORE_OFFSET + other * FLASH_SECTOR_SIZE,
        .data = data,
        .size = size,
        .head = {.magic = MAGIC, .number = head.number + 1U, .size = (uint32_t)size},
    };
    job.head.check = check_of(&job.head, data);
    if (flash_safe_execute(run, &job, HOLD_TIMEOUT_MS) != PICO_OK) {
        return false;
    }
    return valid_head(other, &head) && head.number == job.head.number;
}
