/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Writes to flash while a target runs, and the two sectors of the store.
 *
 * The program is in the same flash chip.  While a sector is erased or programmed, nothing can be read from flash; code
 * that runs from flash at that time would crash.  The control cycle is in RAM, but functions that a user has added to
 * it may be in flash.  Flash is therefore written only while the target is disabled, and core 1 waits in RAM meanwhile.
 *
 * This holds for all code that uses the SDK's flash_safe_execute().  The SDK lets programs replace its protection of
 * core 1 (get_flash_safety_helper()); the one here refuses with PICO_ERROR_NOT_PERMITTED while the target is enabled.
 */
#include "flash.h"

#include <string.h>

#include "parts.h"

/**
 * Place of the store, in bytes from the start of flash: the two sectors before the last one.  Other tools use the last
 * sector; for example, picotool writes a mark there for erratum RP2350-E10.
 */
#ifndef EPG_PICO_STORE_OFFSET
#define EPG_PICO_STORE_OFFSET (PICO_FLASH_SIZE_BYTES - 3 * FLASH_SECTOR_SIZE)
#endif

/** Time for core 1 to end its present cycle and answer. */
#define HOLD_TIMEOUT_MS 300U

/** Bytes of data in a sector: the last page of 256 bytes contains the head. */
#define CAPACITY (FLASH_SECTOR_SIZE - FLASH_PAGE_SIZE)

typedef struct job {
    uint32_t offset; /* of the sector */
    const uint8_t *data;
    size_t size;
    const uint8_t *head;
    size_t head_size;
} job_t;

/* End of the program in flash; defined by the SDK's linker scripts. */
extern char __flash_binary_end;

static uint32_t interrupts;

static bool core_init_deinit(bool init)
{
    (void)init;
    return true;
}

static int enter(uint32_t timeout_ms)
{
    if (get_core_num() != 0U || !epg_pico_control_hold(timeout_ms * 1000U)) {
        return PICO_ERROR_NOT_PERMITTED;
    }
    interrupts = save_and_disable_interrupts();
    return PICO_OK;
}

static int leave(uint32_t timeout_ms)
{
    (void)timeout_ms;
    restore_interrupts(interrupts);
    epg_pico_control_release();
    return PICO_OK;
}

flash_safety_helper_t *get_flash_safety_helper(void)
{
    static flash_safety_helper_t helper = {
        .core_init_deinit = core_init_deinit,
        .enter_safe_zone_timeout_ms = enter,
        .exit_safe_zone_timeout_ms = leave,
    };
    return &helper;
}

/* The store ------------------------------------------------------------------------------------------------------ */

size_t epg_sectors_capacity(void)
{
    return CAPACITY;
}

static const uint8_t *sector(uint32_t index)
{
    return (const uint8_t *)(XIP_BASE + EPG_PICO_STORE_OFFSET + index * FLASH_SECTOR_SIZE);
}

bool epg_sectors_read(uint32_t index, size_t at, void *data, size_t size)
{
    memcpy(data, sector(index) + at, size);
    return true;
}

/**
 * Programs `size` bytes at `offset`, which must be a multiple of a page of 256 bytes.  The rest of the last page stays
 * erased (0xFF).
 */
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
    program(job->offset + CAPACITY, job->head, job->head_size);
}

bool epg_sectors_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size)
{
    if ((uintptr_t)&__flash_binary_end > (uintptr_t)sector(0)) {
        return false;
    }
    job_t job = {
        .offset = EPG_PICO_STORE_OFFSET + index * FLASH_SECTOR_SIZE,
        .data = data,
        .size = size,
        .head = head,
        .head_size = head_size,
    };
    return flash_safe_execute(run, &job, HOLD_TIMEOUT_MS) == PICO_OK;
}
