/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A small store in the flash partition storage_partition.
 *
 * Flash is erased in whole pages, and wears out by this.  The store therefore appends records, one after the other, in
 * up to two pages.  It erases a page only when the other one is full.  The valid record with the highest number is the
 * current one.
 *
 * The power may fail at any moment of a write; afterwards the store must have either all old data or all new data.  A
 * record begins with a head, which contains a checksum.  The data are written first and the head last; without a
 * complete head the new record is not valid, and the old one stays current.
 *
 * A partition of one page is an exception.  When the page is full it must be erased; if the power fails then, nothing
 * is stored any more.
 */
#include <string.h>

#include <zephyr/drivers/flash.h>
#include <zephyr/kernel.h>
#include <zephyr/storage/flash_map.h>

#include "epg/adler32.h"
#include "epg/port.h"
#include "parts.h"

#define PARTITION storage_partition

#if defined(CONFIG_SETTINGS_NVS) || defined(CONFIG_SETTINGS_ZMS) || defined(CONFIG_SETTINGS_FCB)
#error "the application stores its settings in storage_partition: set CONFIG_EPG_STORE=n"
#endif

#define MAGIC 0x53475045U /* "EPGS" */
#define PAGES 2U
/** The largest unit of writing that is supported, in bytes.  Flash can be written in whole units only. */
#define ALIGN_MAX 64U

typedef struct head {
    uint32_t magic;
    uint32_t number; /* counts the writes, from 1 */
    uint32_t size;   /* bytes of data */
    uint32_t check;  /* Adler-32 of number, size and data */
} head_t;

static struct {
    const struct flash_area *area;
    uint32_t page_size;
    uint32_t page_count;
    uint32_t align;
} flash;

/** The place of the newest record and of the next one. */
typedef struct place {
    bool found; /* there is a valid record */
    head_t head;
    uint32_t at;   /* offset of its head in the partition */
    uint32_t page; /* number of its page; 0 if there is no record */
    uint32_t end;  /* offset in this page, at which the next record begins */
} place_t;

static bool open_partition(void)
{
    struct flash_pages_info first;
    if (flash.area != NULL) {
        return true;
    }
    const struct flash_area *area;
    if (flash_area_open(FIXED_PARTITION_ID(PARTITION), &area) < 0 ||
        flash_get_page_info_by_offs(area->fa_dev, area->fa_off, &first) < 0) {
        return false;
    }
    flash.page_size = (uint32_t)first.size;
    flash.page_count = MIN((uint32_t)(area->fa_size / first.size), PAGES);
    flash.align = MAX(flash_area_align(area), 4U);
    if (flash.page_count == 0U || flash.align > ALIGN_MAX) {
        return false;
    }
    flash.area = area;
    return true;
}

static uint32_t head_size(void)
{
    return (uint32_t)ROUND_UP(sizeof(head_t), flash.align);
}

static uint32_t record_size(uint32_t size)
{
    return head_size() + (uint32_t)ROUND_UP(size, flash.align);
}

static uint32_t check_of_head(const head_t *head)
{
    return epg_adler32(epg_adler32(1U, &head->number, sizeof head->number), &head->size, sizeof head->size);
}

/** True if the data after the head at offset `at` have its checksum. */
static bool valid(const head_t *head, uint32_t at)
{
    uint8_t piece[ALIGN_MAX];
    uint32_t sum = check_of_head(head);
    for (uint32_t done = 0; done < head->size; done += sizeof piece) {
        const size_t size = MIN(sizeof piece, head->size - done);
        if (flash_area_read(flash.area, (off_t)(at + head_size() + done), piece, size) < 0) {
            return false;
        }
        sum = epg_adler32(sum, piece, size);
    }
    return sum == head->check;
}

/** Goes through the records of a page, and updates `*place` if a valid record is newer than the one found so far. */
static void scan(uint32_t page, place_t *place)
{
    const uint32_t begin = page * flash.page_size;
    uint32_t end = 0;
    bool newest = false;
    while (end + head_size() <= flash.page_size) {
        head_t head;
        if (flash_area_read(flash.area, (off_t)(begin + end), &head, sizeof head) < 0 || head.magic != MAGIC ||
            head.size > flash.page_size - head_size() - end) {
            break;
        }
        if ((!place->found || (int32_t)(head.number - place->head.number) > 0) && valid(&head, begin + end)) {
            *place = (place_t){.found = true, .head = head, .at = begin + end, .page = page};
            newest = true;
        }
        end += record_size(head.size);
    }
    if (newest || (page == 0U && !place->found)) {
        place->end = end;
    }
}

static place_t find(void)
{
    place_t place = {0};
    for (uint32_t page = 0; page < flash.page_count; page++) {
        scan(page, &place);
    }
    return place;
}

static bool erased(uint32_t at, uint32_t size)
{
    uint8_t piece[ALIGN_MAX];
    const uint8_t empty = flash_area_erased_val(flash.area);
    for (uint32_t done = 0; done < size; done += sizeof piece) {
        const size_t count = MIN(sizeof piece, size - done);
        if (flash_area_read(flash.area, (off_t)(at + done), piece, count) < 0) {
            return false;
        }
        for (size_t i = 0; i < count; i++) {
            if (piece[i] != empty) {
                return false;
            }
        }
    }
    return true;
}

/** Writes `size` bytes in whole units.  The rest of the last unit is written with the value of erased flash. */
static bool program(uint32_t at, const void *data, size_t size)
{
    uint8_t unit[ALIGN_MAX];
    const uint8_t *bytes = data;
    for (size_t done = 0; done < size; done += flash.align) {
        const size_t part = MIN(flash.align, size - done);
        memset(unit, flash_area_erased_val(flash.area), sizeof unit);
        memcpy(unit, bytes + done, part);
        if (flash_area_write(flash.area, (off_t)(at + done), unit, flash.align) < 0) {
            return false;
        }
    }
    return true;
}

static bool write(const void *data, size_t size)
{
    const place_t place = find();
    const uint32_t needed = record_size((uint32_t)size);
    uint32_t at = place.page * flash.page_size + place.end;
    if (needed > flash.page_size - place.end || !erased(at, needed)) {
        at = place.found ? (place.page + 1U) % flash.page_count * flash.page_size : 0U;
        if (flash_area_erase(flash.area, (off_t)at, flash.page_size) < 0) {
            return false;
        }
    }
    head_t head = {.magic = MAGIC, .number = place.head.number + 1U, .size = (uint32_t)size};
    head.check = epg_adler32(check_of_head(&head), data, size);
    if (!program(at + head_size(), data, size) || !program(at, &head, sizeof head)) {
        return false;
    }
    const place_t newest = find();
    return newest.found && newest.head.number == head.number;
}

size_t epg_port_store_read(void *data, size_t size)
{
    if (!open_partition()) {
        return 0;
    }
    const place_t place = find();
    const size_t count = MIN(place.head.size, size);
    if (!place.found || flash_area_read(flash.area, (off_t)(place.at + head_size()), data, count) < 0) {
        return 0;
    }
    return count;
}

bool epg_port_store_write(const void *data, size_t size)
{
    if (!open_partition() || size > flash.page_size - head_size() - ALIGN_MAX || !epg_zephyr_control_hold()) {
        return false;
    }
    epg_zephyr_watchdog_relax(true);
    const bool written = write(data, size);
    epg_zephyr_watchdog_relax(false);
    epg_zephyr_control_release();
    return written;
}
