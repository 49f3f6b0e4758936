/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32H7: those registers of resets, of the backup registers and of the watchdog that differ between series.
 */
#include "../reset.h"

#include "../parts.h"

uint32_t epg_stm32_reset_read(void)
{
    return RCC->RSR;
}

bool epg_stm32_reset_by_watchdog(uint32_t flags)
{
    return (flags & RCC_RSR_IWDG1RSTF) != 0U;
}

void epg_stm32_reset_clear(void)
{
    RCC->RSR |= RCC_RSR_RMVF;
}

void epg_stm32_backup_clock(void)
{
    RCC->APB4ENR |= RCC_APB4ENR_RTCAPBEN;
    (void)RCC->APB4ENR;
}

IWDG_TypeDef *EPG_STM32_CYCLE(epg_stm32_watchdog)(void)
{
    return IWDG1;
}

bool epg_stm32_watchdog_has_clock(void)
{
    /* The watchdog enables LSI without LSION (RM0433, 45.3). */
    return (RCC->CSR & (RCC_CSR_LSION | RCC_CSR_LSIRDY)) == RCC_CSR_LSIRDY;
}

void epg_stm32_watchdog_freeze(void)
{
    DBGMCU->APB4FZ1 |= DBGMCU_APB4FZ1_DBG_IWDG1;
}
