/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32F7 with 2 MiB of flash: the two sectors of the store, which are the last two.
 *
 * The option bit nDBANK chooses between two organizations of the flash (RM0410, "Flash memory organization").
 *
 * **Two banks** (nDBANK = 0), sectors of 128 KiB: bank 1, which has the program, can be read while bank 2 is erased or
 * programmed.  A program that reaches into bank 2 would stop for seconds: then nothing is stored.
 *
 * **One bank** (nDBANK = 1, as the chip is delivered), sectors of 256 KiB: nothing in flash can be read meanwhile.  A core
 * that tries to would stop for seconds, also in the tick, and the watchdog would not be fed.  Therefore the functions that
 * wait for the flash are code of the cycle, and keep all interrupts but the tick and the clock out.  If the linker script
 * has not put the cycle, its tables and its vectors into RAM, as EPG's own does, nothing is stored.
 *
 * The flash has no code that detects errors (ECC): a word that was programmed only in part has wrong bits.  The checksum
 * of the record detects them.
 */
#include <string.h>

#include "../cache.h"
#include "../parts.h"
#include "epg/control.h"
#include "epg/sectors.h"

#define BEGIN 0x08000000U
#define BANK_2 0x08100000U
#define END 0x08200000U
/** The same flash at the address by which the core reads it without its caches (RM0410, "Memory organization"). */
#define ALIAS 0x00200000U
#define ALIAS_END 0x00400000U
#define KIB 2048U

#define SECTORS 2U
/** Bytes at the end of a sector for the head of the record. */
#define HEAD 32U

/* RM0410, FLASH_KEYR: the keys that unlock FLASH_CR */
#define KEY_1 0x45670123U
#define KEY_2 0xCDEF89ABU
/** PSIZE = 2: 32 bits are programmed at once, which needs a supply of 2.7 V (RM0410, FLASH_CR). */
#define BY_WORDS FLASH_CR_PSIZE_1

/** Longest erasure of a sector and programming of a word, with a margin (DS11532, flash memory characteristics). */
#define ERASE_US 5000000U
#define PROGRAM_US 10000U

#define ERRORS (FLASH_SR_OPERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_PGPERR | FLASH_SR_ERSERR)

/** Code that runs while the flash cannot be read: never a part of a function that is in flash. */
#define BESIDE_FLASH(name) __attribute__((noinline)) EPG_STM32_CYCLE(name)

/* The end of the program in flash: store.ld. */
extern const char epg_stm32_image_end;

static inline bool two_banks(void)
{
    return (FLASH->OPTCR & FLASH_OPTCR_nDBANK) == 0U;
}

static uint32_t sector_size(void)
{
    return two_banks() ? 0x20000U : 0x40000U;
}

static uintptr_t sector_begin(uint32_t index)
{
    return END - (SECTORS - index) * sector_size();
}

size_t epg_sectors_capacity(void)
{
    const uint32_t kib = *(const volatile uint16_t *)FLASHSIZE_BASE;
    return kib == KIB ? sector_size() - HEAD : 0U;
}

bool epg_sectors_read(uint32_t index, size_t at, void *data, size_t size)
{
    memcpy(data, (const void *)(sector_begin(index) + at), size);
    return true;
}

/* Writing -------------------------------------------------------------------------------------------------------- */

/** With one bank, keeps all interrupts but the tick out until epg_stm32_leave(). */
static uint32_t BESIDE_FLASH(begin)(void)
{
    return two_banks() ? __get_BASEPRI() : epg_stm32_enter();
}

/** Waits until the flash has done its work.  Returns false after an error, or after `longest_us`. */
static bool BESIDE_FLASH(wait_for_flash)(uint32_t longest_us)
{
    const uint64_t begin_us = epg_stm32_time_us();
    while ((FLASH->SR & FLASH_SR_BSY) != 0U) {
        if (epg_stm32_time_us() - begin_us > longest_us) {
            return false;
        }
    }
    return (FLASH->SR & ERRORS) == 0U;
}

/** RM0410, "Sector erase".  `number` is the value of SNB. */
static bool BESIDE_FLASH(erase)(uint32_t number)
{
    const uint32_t before = begin();
    FLASH->CR = BY_WORDS | FLASH_CR_SER | number << FLASH_CR_SNB_Pos;
    FLASH->CR |= FLASH_CR_STRT;
    __DSB();
    const bool good = wait_for_flash(ERASE_US);
    FLASH->CR = 0U;
    epg_stm32_leave(before);
    return good;
}

/** RM0410, "Flash memory programming sequence". */
static bool BESIDE_FLASH(program_word)(uintptr_t address, uint32_t word)
{
    const uint32_t before = begin();
    FLASH->CR = BY_WORDS | FLASH_CR_PG;
    *(volatile uint32_t *)address = word;
    __DSB();
    const bool good = wait_for_flash(PROGRAM_US);
    FLASH->CR = 0U;
    epg_stm32_leave(before);
    return good;
}

/** Programs whole words from `address` on.  The rest of the last word stays as after the erasure: 0xFF. */
static bool program(uintptr_t address, const void *data, size_t size)
{
    const uint8_t *from = data;
    for (size_t done = 0; done < size; done += sizeof(uint32_t)) {
        uint32_t word = 0xFFFFFFFFU;
        memcpy(&word, from + done, size - done < sizeof word ? size - done : sizeof word);
        if (!program_word(address + done, word)) {
            return false;
        }
    }
    return true;
}

/** The address at which the sectors are erased and programmed, for one that may be in the alias. */
static uintptr_t in_flash(uintptr_t address)
{
    return address >= ALIAS && address <= ALIAS_END ? address - ALIAS + BEGIN : address;
}

static bool is_in_flash(uintptr_t address)
{
    return in_flash(address) >= BEGIN && in_flash(address) < END;
}

/** True if the tick needs nothing from flash: EPG's linker script puts all parts of the cycle into RAM. */
static bool cycle_is_in_ram(void)
{
    return !is_in_flash((uintptr_t)&wait_for_flash) && !is_in_flash((uintptr_t)&epg_control_cycle) &&
           !is_in_flash((uintptr_t)&epg_stm32_hardware) && !is_in_flash(SCB->VTOR);
}

/** True if the sectors can be written without stopping the tick or overwriting the program. */
static bool can_write(void)
{
    const uintptr_t image = in_flash((uintptr_t)&epg_stm32_image_end);
    const uintptr_t limit = two_banks() ? BANK_2 : sector_begin(0U);
    return (image <= limit || image >= END) && (two_banks() || cycle_is_in_ram()) && epg_sectors_capacity() > 0U &&
           (FLASH->SR & FLASH_SR_BSY) == 0U;
}

bool epg_sectors_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size)
{
    if (!can_write() || !epg_one_core_hold()) {
        return false;
    }
    const uintptr_t sector = sector_begin(index);
    const uintptr_t place = sector + epg_sectors_capacity();
    /* The last sectors: 10 and 11 of one bank; 22 and 23 of two, whose second half counts from 16 (RM0410, FLASH_CR). */
    const uint32_t number = (two_banks() ? 26U : 10U) + index;
    const bool locked = (FLASH->CR & FLASH_CR_LOCK) != 0U;
    if (locked) {
        FLASH->KEYR = KEY_1;
        FLASH->KEYR = KEY_2;
    }
    FLASH->SR = ERRORS | FLASH_SR_EOP; /* writing 1 clears the flags */
    const bool written = erase(number) && program(sector, data, size) && program(place, head, head_size);
    if (locked) {
        FLASH->CR |= FLASH_CR_LOCK;
    }
    epg_stm32_cache_drop((void *)sector, sector_size()); /* the cache has bytes from before */
    epg_one_core_release();
    return written && memcmp((const void *)sector, data, size) == 0 &&
           memcmp((const void *)place, head, head_size) == 0;
}
