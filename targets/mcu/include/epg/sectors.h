/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Two sectors of flash, in which the store keeps its records.
 *
 * Flash keeps its contents without power.  It is erased in whole sectors, and programmed once after that.  The store
 * uses two sectors in turn (`mcu/src/store.c`), so that the old data stay until the new ones are complete.  A sector
 * holds data from its beginning on, and a head after the place for the data.
 *
 * A family of chips implements these functions, and so does the platform zephyr.
 */
#ifndef EPG_SECTORS_H
#define EPG_SECTORS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Bytes of data that a sector can hold before its head; 0 if there are no sectors. */
size_t epg_sectors_capacity(void);

/**
 * Copies `size` bytes of sector `index`, 0 or 1, from offset `at` on.  The head is at offset epg_sectors_capacity().
 * Returns false if they cannot be read.  This happens on flash with ECC, if the power failed while a word was being
 * programmed.
 */
bool epg_sectors_read(uint32_t index, size_t at, void *data, size_t size);

/**
 * Erases sector `index`, programs `size` bytes of `data`, and the head last.  No place is programmed twice.
 *
 * Returns false if the flash must not be written: the target is enabled, or the sector is a part of the program.
 */
bool epg_sectors_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size);

#endif
