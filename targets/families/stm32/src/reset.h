/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The watchdog, and the causes of a reset.
 */
#ifndef EPG_STM32_RESET_H
#define EPG_STM32_RESET_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/stm32_device.h"

/* watchdog.c --------------------------------------------------------------------------------------------------- */

/** Feeds the watchdog while no target runs, because it cannot be stopped.  TIM7's interrupt calls it every 65 ms. */
void epg_stm32_watchdog_feed_alone(void);

/** From now on only a running target feeds the watchdog. */
void epg_stm32_watchdog_abandon(void);

/* f7, h7: reset.c ---------------------------------------------------------------------------------------------- */

/** The flags of the last resets. */
uint32_t epg_stm32_reset_read(void);

/** True if `flags` say that the independent watchdog has reset the chip. */
bool epg_stm32_reset_by_watchdog(uint32_t flags);

/** Clears the flags. */
void epg_stm32_reset_clear(void);

/** Switches the clocks on that the backup registers and PWR_CR1 need. */
void epg_stm32_backup_clock(void);

/** The registers of the independent watchdog. */
IWDG_TypeDef *epg_stm32_watchdog(void);

/** True if the clock of the watchdog runs although the program has not enabled it: the watchdog runs. */
bool epg_stm32_watchdog_has_clock(void);

/** Stops the watchdog while a debugger has stopped the core. */
void epg_stm32_watchdog_freeze(void);

#endif
