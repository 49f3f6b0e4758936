/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The two sectors of the store: the first two pages of the flash partition storage_partition.
 */
#include <string.h>

#include <zephyr/drivers/flash.h>
#include <zephyr/kernel.h>
#include <zephyr/storage/flash_map.h>

#include "epg/sectors.h"
#include "parts.h"

#define PARTITION storage_partition

#if defined(CONFIG_SETTINGS_NVS) || defined(CONFIG_SETTINGS_ZMS) || defined(CONFIG_SETTINGS_FCB)
#error "the application stores its settings in storage_partition: set CONFIG_EPG_STORE=n"
#endif

#define SECTORS 2U
/** The largest unit of writing that is supported, in bytes.  Flash can be written in whole units only. */
#define UNIT_MAX 64U
/** Bytes for the head of a record, at the end of a page: a multiple of each unit of writing. */
#define HEAD_SIZE UNIT_MAX

static struct {
    const struct flash_area *area; /* NULL: there is no usable partition */
    uint32_t page_size;
    uint32_t unit;
} flash;

size_t epg_sectors_capacity(void)
{
    struct flash_pages_info first;
    const struct flash_area *area;
    if (flash.area == NULL && flash_area_open(FIXED_PARTITION_ID(PARTITION), &area) >= 0 &&
        flash_get_page_info_by_offs(area->fa_dev, area->fa_off, &first) >= 0 && area->fa_size >= SECTORS * first.size &&
        flash_area_align(area) <= UNIT_MAX) {
        flash.area = area;
        flash.page_size = (uint32_t)first.size;
        flash.unit = MAX(flash_area_align(area), 4U);
    }
    return flash.area != NULL ? flash.page_size - HEAD_SIZE : 0U;
}

bool epg_sectors_read(uint32_t index, size_t at, void *data, size_t size)
{
    return flash.area != NULL && flash_area_read(flash.area, (off_t)(index * flash.page_size + at), data, size) >= 0;
}

/** Writes `size` bytes in whole units.  The rest of the last unit is written with the value of erased flash. */
static bool program(uint32_t at, const void *data, size_t size)
{
    uint8_t unit[UNIT_MAX];
    const uint8_t *bytes = data;
    for (size_t done = 0; done < size; done += flash.unit) {
        const size_t part = MIN(flash.unit, size - done);
        memset(unit, flash_area_erased_val(flash.area), sizeof unit);
        memcpy(unit, bytes + done, part);
        if (flash_area_write(flash.area, (off_t)(at + done), unit, flash.unit) < 0) {
            return false;
        }
    }
    return true;
}

bool epg_sectors_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size)
{
    const uint32_t begin = index * flash.page_size;
    if (!epg_zephyr_control_hold()) {
        return false;
    }
    epg_zephyr_watchdog_relax(true);
    const bool written = flash_area_erase(flash.area, (off_t)begin, flash.page_size) >= 0 &&
                         program(begin, data, size) && program(begin + flash.page_size - HEAD_SIZE, head, head_size);
    epg_zephyr_watchdog_relax(false);
    epg_zephyr_control_release();
    return written;
}
