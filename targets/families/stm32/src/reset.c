/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The fault that ended the run before a reset.
 *
 * A backup register of the RTC remembers a fault of the processor (RM0433, 46.6).  It needs no place in a linker
 * script, and a reset does not change it.  Backup registers lose their contents only without VDD and VBAT.  A fault
 * before the power was switched off is therefore also reported after it is switched on, if VBAT has a battery.
 */
#include "reset.h"

#include "parts.h"

/** Number of the backup register: 0 to 31.  The program must not use it. */
#ifndef EPG_STM32_BACKUP_REGISTER
#define EPG_STM32_BACKUP_REGISTER 31
#endif
#define FAULT_MAGIC 0xEF4A17EDU

/** Readings until DBP has its new value. */
#define READINGS 1000U

static uint32_t flags;

static volatile uint32_t *fault_word(void)
{
    return &RTC->BKP0R + EPG_STM32_BACKUP_REGISTER;
}

/** Gives the core access to the backup registers: the clock of the bus for reading, DBP for writing (RM0433, 6.8). */
static void open_backup_registers(void)
{
    epg_stm32_backup_clock();
    PWR->CR1 |= PWR_CR1_DBP;
    for (uint32_t i = 0; i < READINGS && (PWR->CR1 & PWR_CR1_DBP) == 0U; i++) {
    }
}

void epg_one_core_remember_fault(void)
{
    epg_stm32_watchdog_abandon();
    open_backup_registers();
    *fault_word() = FAULT_MAGIC;
    __DSB();
}

epg_fault_t epg_family_fault_before_reset(void)
{
    epg_fault_t fault = EPG_FAULT_NONE;
    flags = epg_stm32_reset_read();
    if (epg_stm32_reset_by_watchdog(flags)) {
        fault = EPG_FAULT_WATCHDOG;
        /* The flag would stay set over the next resets, which have other causes (RM0433, 8.7). */
        epg_stm32_reset_clear();
    }
    epg_stm32_backup_clock();
    const bool was_open = (PWR->CR1 & PWR_CR1_DBP) != 0U;
    open_backup_registers();
    if (*fault_word() == FAULT_MAGIC) {
        fault = EPG_FAULT_PROCESSOR;
        *fault_word() = 0U;
        __DSB();
    }
    if (!was_open) {
        PWR->CR1 &= ~PWR_CR1_DBP;
    }
    return fault;
}

uint32_t epg_stm32_reset_flags(void)
{
    return flags;
}
