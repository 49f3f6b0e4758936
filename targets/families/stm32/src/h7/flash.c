/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32H7: the two sectors of the store, which are the last two of flash bank 2.
 *
 * The program is in bank 1.  A bank can be read while the other one is erased or programmed, so the control cycle goes
 * on.  A program that reaches into bank 2 would stop for seconds: then nothing is stored.
 *
 * **Words.**  Flash is programmed in words of 32 bytes, each with a code that corrects one wrong bit and detects two
 * (ECC; RM0433, 4.3.12).  A word is programmed once after it was erased: a second time would destroy its code.
 *
 * **Half-written words.**  If the power fails while a word is programmed or a sector is erased, its code is wrong, and
 * reading it raises a BusFault, after each restart again.  Each word is therefore read while bus faults of data
 * accesses are ignored: FAULTMASK = 1 raises the priority of execution to -1, and BFHFNMIGN in the CCR makes the core
 * ignore these faults at that priority (DDI 0403, B1.5.4 and B3.2.8).  This delays the tick, for the time of one word.
 */
#include <string.h>

#include "../cache.h"
#include "../parts.h"
#include "epg/sectors.h"

#define BANK_2 FLASH_BANK2_BASE
#define BANKS_END 0x08200000U
#define SECTOR 0x20000U
#define SECTORS 2U
/** Bytes of a flash word. */
#define WORD 32U
#define WORDS (WORD / sizeof(uint32_t))
/** Bytes of data in a sector: the head has the last word for itself. */
#define CAPACITY (SECTOR - WORD)

/* RM0433, 4.9.24: the keys that unlock CR2 */
#define KEY_1 0x45670123U
#define KEY_2 0xCDEF89ABU

/** Longest erasure of a sector and programming of a word, with a margin (DS12110, flash memory characteristics). */
#define ERASE_US 5000000U
#define PROGRAM_US 10000U

#define BUSY (FLASH_SR_BSY | FLASH_SR_WBNE | FLASH_SR_QW)
#define ERRORS (FLASH_SR_WRPERR | FLASH_SR_PGSERR | FLASH_SR_STRBERR | FLASH_SR_INCERR | FLASH_SR_OPERR)

/* The end of the program in flash: store.ld. */
extern const char epg_stm32_image_end;

/** The first sector of the store.  Chips with 1 MiB of flash have half of the sectors in each bank. */
static uintptr_t store(void)
{
    const uint32_t kib = *(const volatile uint16_t *)FLASHSIZE_BASE;
    return BANK_2 + (kib == 1024U ? 0x80000U : 0x100000U) - SECTORS * SECTOR;
}

size_t epg_sectors_capacity(void)
{
    /* With swapped banks the program would be in the bank of the store (RM0433, 4.3.13). */
    return (FLASH->OPTCR & FLASH_OPTCR_SWAP_BANK) == 0U ? CAPACITY : 0U;
}

/* Reading -------------------------------------------------------------------------------------------------------- */

/** Reads the word at `address`, a multiple of 32.  Returns false if its code shows that it is damaged. */
static bool read_word(uintptr_t address, uint32_t word[WORDS])
{
    const volatile uint32_t *from = (const volatile uint32_t *)address;
    FLASH->CCR2 = FLASH_CCR_CLR_DBECCERR | FLASH_CCR_CLR_SNECCERR;
    const uint32_t mask = __get_FAULTMASK();
    const uint32_t control = SCB->CCR;
    const uint32_t faults = SCB->CFSR;
    __set_FAULTMASK(1U);
    SCB->CCR = control | SCB_CCR_BFHFNMIGN_Msk;
    __DSB();
    __ISB();
    for (uint32_t i = 0; i < WORDS; i++) {
        word[i] = from[i];
    }
    __DSB();
    const uint32_t raised = SCB->CFSR & SCB_CFSR_BUSFAULTSR_Msk & ~faults;
    SCB->CFSR = raised; /* writing 1 clears the flags */
    SCB->CCR = control;
    __DSB();
    __ISB();
    __set_FAULTMASK(mask);
    return raised == 0U && (FLASH->SR2 & FLASH_SR_DBECCERR) == 0U;
}

bool epg_sectors_read(uint32_t index, size_t at, void *data, size_t size)
{
    uint8_t *to = data;
    const uintptr_t begin = store() + index * SECTOR;
    while (size > 0U) {
        uint32_t word[WORDS];
        const size_t skip = at % WORD;
        const size_t part = size < WORD - skip ? size : WORD - skip;
        if (!read_word(begin + at - skip, word)) {
            return false;
        }
        memcpy(to, (const uint8_t *)word + skip, part);
        to += part;
        at += part;
        size -= part;
    }
    return true;
}

/* Writing -------------------------------------------------------------------------------------------------------- */

/** Waits until bank 2 has done its work.  Returns false after an error, or after `longest_us`. */
static bool wait(uint32_t longest_us)
{
    const uint32_t begin_us = epg_family_time_us();
    while ((FLASH->SR2 & BUSY) != 0U) {
        if (epg_family_time_us() - begin_us > longest_us) {
            return false;
        }
    }
    return (FLASH->SR2 & ERRORS) == 0U;
}

/** RM0433, 4.3.10: sequence of a sector erasure. */
static bool erase(uintptr_t sector)
{
    const uint32_t number = (uint32_t)(sector - BANK_2) / SECTOR;
    FLASH->CR2 = (FLASH->CR2 & ~FLASH_CR_SNB) | FLASH_CR_SER | number << FLASH_CR_SNB_Pos;
    FLASH->CR2 |= FLASH_CR_START;
    __DSB();
    const bool good = wait(ERASE_US);
    FLASH->CR2 &= ~(FLASH_CR_SER | FLASH_CR_SNB);
    return good;
}

/** Programs one word at `address`.  RM0433, 4.3.9: sequence of a single write. */
static bool program_word(uintptr_t address, const uint32_t word[WORDS])
{
    volatile uint32_t *to = (volatile uint32_t *)address;
    FLASH->CR2 |= FLASH_CR_PG;
    __DSB();
    for (uint32_t i = 0; i < WORDS; i++) {
        to[i] = word[i];
    }
    /* Normally flash is written through the cache.  A user's MPU region can change that. */
    epg_stm32_cache_clean((const void *)address, WORD);
    const bool good = wait(PROGRAM_US);
    FLASH->CR2 &= ~FLASH_CR_PG;
    return good;
}

/** Programs whole words from `address` on.  The rest of the last word stays as after the erasure: 0xFF. */
static bool program(uintptr_t address, const void *data, size_t size)
{
    const uint8_t *from = data;
    for (size_t done = 0; done < size; done += WORD) {
        uint32_t word[WORDS];
        const size_t part = size - done < WORD ? size - done : WORD;
        memset(word, 0xFF, sizeof word);
        memcpy(word, from + done, part);
        if (!program_word(address + done, word)) {
            return false;
        }
    }
    return true;
}

/** True if flash bank 2 can be written without stopping or overwriting the program. */
static bool bank_is_free(void)
{
    const uintptr_t image = (uintptr_t)&epg_stm32_image_end;
    return (image <= BANK_2 || image >= BANKS_END) && epg_sectors_capacity() > 0U && (FLASH->SR2 & BUSY) == 0U;
}

bool epg_sectors_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size)
{
    if (!bank_is_free() || !epg_one_core_hold()) {
        return false;
    }
    const uintptr_t sector = store() + index * SECTOR;
    const bool locked = (FLASH->CR2 & FLASH_CR_LOCK) != 0U;
    if (locked) {
        FLASH->KEYR2 = KEY_1;
        FLASH->KEYR2 = KEY_2;
    }
    FLASH->CCR2 = ERRORS | FLASH_CCR_CLR_EOP; /* SR and CCR have the same flags (RM0433, 4.9.26, 4.9.27) */
    const bool written = erase(sector) && program(sector, data, size) && program(sector + CAPACITY, head, head_size);
    if (locked) {
        FLASH->CR2 |= FLASH_CR_LOCK;
    }
    epg_stm32_cache_drop((void *)sector, SECTOR); /* the cache has bytes from before */
    epg_one_core_release();
    return written;
}
