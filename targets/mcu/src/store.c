/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A small store in flash, on the platforms bare_metal, freertos and zephyr.
 *
 * It uses two sectors in turn.  Each sector holds one record: data, and a head with number, size and checksum.  The
 * valid record with the higher number is the current one.
 *
 * The power may fail at any moment of a write; afterwards the store must have either all old data or all new data.
 * Therefore a write leaves the sector of the current record alone.  It erases the other sector, programs the data
 * there, and programs the head last.  Without a complete head the new record is not valid, and the old one stays
 * current.
 */
#include "epg/adler32.h"
#include "epg/port.h"
#include "epg/sectors.h"

#define MAGIC 0x53475045U /* "EPGS" */
#define SECTORS 2U

typedef struct head {
    uint32_t magic;
    uint32_t number; /* counts the writes, from 1 */
    uint32_t size;   /* bytes of data */
    uint32_t check;  /* Adler-32 of number, size and data */
} head_t;

/** Bytes that are read at once to compute a checksum. */
#define PIECE 64U

static uint32_t check_of_head(const head_t *head)
{
    return epg_adler32(epg_adler32(1U, &head->number, sizeof head->number), &head->size, sizeof head->size);
}

/** Copies the head of a sector into `*head`.  False if the sector has no valid record. */
static bool valid_head(uint32_t index, head_t *head)
{
    const size_t capacity = epg_sectors_capacity();
    if (!epg_sectors_read(index, capacity, head, sizeof *head) || head->magic != MAGIC || head->size > capacity) {
        return false;
    }
    uint8_t piece[PIECE];
    uint32_t sum = check_of_head(head);
    for (size_t done = 0; done < head->size; done += sizeof piece) {
        const size_t size = head->size - done < sizeof piece ? head->size - done : sizeof piece;
        if (!epg_sectors_read(index, done, piece, size)) {
            return false;
        }
        sum = epg_adler32(sum, piece, size);
    }
    return sum == head->check;
}

/** Finds the sector of the current record.  False if nothing is stored. */
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

size_t epg_port_store_read(void *data, size_t size)
{
    uint32_t index;
    head_t head;
    if (!newest(&index, &head)) {
        return 0;
    }
    const size_t count = head.size < size ? head.size : size;
    return epg_sectors_read(index, 0, data, count) ? count : 0U;
}

const char *epg_port_store_write(const void *data, size_t size)
{
    static const char *const failed = "the flash memory could not be written";
    if (size > epg_sectors_capacity()) {
        return "the flash memory for it is too small";
    }
    uint32_t index = 1U;
    head_t head = {0};
    (void)newest(&index, &head);
    const uint32_t other = 1U - index;
    head_t next = {.magic = MAGIC, .number = head.number + 1U, .size = (uint32_t)size};
    next.check = epg_adler32(check_of_head(&next), data, size);
    if (!epg_sectors_write(other, data, size, &next, sizeof next)) {
        return failed;
    }
    return valid_head(other, &head) && head.number == next.number ? NULL : failed;
}
