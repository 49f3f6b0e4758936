/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32F7: the clock of the random number generator is that of USB (RM0410, RCC_DCKCFGR2, CK48MSEL).  The program has
 * made it, or not.
 */
#include "../parts.h"

void epg_stm32_random_clock(bool on)
{
    (void)on;
}
