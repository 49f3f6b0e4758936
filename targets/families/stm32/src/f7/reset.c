/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32F7: those registers of resets, of the backup registers and of the watchdog that differ between series.
 */
#include "../reset.h"

#include "../parts.h"

uint32_t epg_stm32_reset_read(void)
{
    return RCC->CSR;
}

bool epg_stm32_reset_by_watchdog(uint32_t flags)
{
    return (flags & RCC_CSR_IWDGRSTF) != 0U;
}

void epg_stm32_reset_clear(void)
{
    RCC->CSR |= RCC_CSR_RMVF;
}

void epg_stm32_backup_clock(void)
{
    /* RM0410, PWR: DBP is in a register of PWR, which has no clock after a reset. */
    RCC->APB1ENR |= RCC_APB1ENR_PWREN | RCC_APB1ENR_RTCEN;
    (void)RCC->APB1ENR;
}

IWDG_TypeDef *EPG_STM32_CYCLE(epg_stm32_watchdog)(void)
{
    return IWDG;
}

bool epg_stm32_watchdog_has_clock(void)
{
    /* The watchdog enables LSI without LSION (RM0410, IWDG). */
    return (RCC->CSR & (RCC_CSR_LSION | RCC_CSR_LSIRDY)) == RCC_CSR_LSIRDY;
}

void epg_stm32_watchdog_freeze(void)
{
    DBGMCU->APB1FZ |= DBGMCU_APB1_FZ_DBG_IWDG_STOP;
}
