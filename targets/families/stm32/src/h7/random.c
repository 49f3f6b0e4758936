/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32H7: the clock of the random number generator.  After a reset it is HSI48 (RM0433, 8.7.21, RNGSEL), which is off.
 */
#include "../parts.h"

void epg_stm32_random_clock(bool on)
{
    static bool started;
    if (on) {
        started = (RCC->D2CCIP2R & RCC_D2CCIP2R_RNGSEL_Msk) == 0U && (RCC->CR & RCC_CR_HSI48ON) == 0U;
        RCC->CR |= started ? RCC_CR_HSI48ON : 0U;
    } else {
        RCC->CR &= started ? ~RCC_CR_HSI48ON : ~0U;
    }
}
