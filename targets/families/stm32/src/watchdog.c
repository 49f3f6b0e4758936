/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The independent watchdog (RM0433, 45).  Once started it runs until the next reset, from its own clock of 32 kHz.
 * That clock can differ by 7 % on STM32H7 (DS12110, LSI oscillator characteristics), and has 17 to 47 kHz on STM32F7
 * (DS11532).
 *
 * **Ownership.**  If the program has started it, EPG neither changes nor feeds it.  The chip cannot be asked whether it
 * runs.  EPG concludes it from registers that differ from their values after a reset, and from its clock, which runs
 * although the program has not enabled it.  A program that enables that clock itself and starts the watchdog with the
 * values of a reset is not noticed.  It must be compiled with EPG_STM32_WATCHDOG=0: EPG then does not use the watchdog.
 *
 * A debugger that stops the core also stops the watchdog.
 */
#include "parts.h"
#include "reset.h"

#ifndef EPG_STM32_WATCHDOG
#define EPG_STM32_WATCHDOG 1
#endif

/* RM0433, 45.4.1: keys */
#define KEY_START 0xCCCCU
#define KEY_WRITE 0x5555U
#define KEY_FEED 0xAAAAU

#define CLOCK_HZ 32000U
#define RELOAD_MAX 0xFFFU
/** PR = 0 divides by 4, each further value by twice as much, up to 256 (RM0433, 45.4.2). */
#define SMALLEST_DIVIDER 4U
#define LARGEST_PRESCALER 6U
/** A register takes over a new value within 6 clocks of the largest divider, which are 90 ms at 17 kHz. */
#define UPDATE_US 100000U

static bool mine EPG_STM32_CYCLE_DATA;  /* EPG has started the watchdog */
static bool alone EPG_STM32_CYCLE_DATA; /* no target runs: the interrupt of the clock feeds */

static bool belongs_to_program(const IWDG_TypeDef *iwdg)
{
    return iwdg->PR != 0U || iwdg->RLR != RELOAD_MAX || iwdg->WINR != RELOAD_MAX || epg_stm32_watchdog_has_clock();
}

static void wait_for_update(const IWDG_TypeDef *iwdg)
{
    const uint32_t begin_us = epg_family_time_us();
    while ((iwdg->SR & (IWDG_SR_PVU | IWDG_SR_RVU)) != 0U && epg_family_time_us() - begin_us < UPDATE_US) {
    }
}

void epg_one_core_watchdog_start(uint32_t timeout_ms)
{
    IWDG_TypeDef *iwdg = epg_stm32_watchdog();
    if (EPG_STM32_WATCHDOG == 0 || (!mine && belongs_to_program(iwdg))) {
        return;
    }
    const uint32_t clocks = timeout_ms * (CLOCK_HZ / 1000U) / SMALLEST_DIVIDER;
    uint32_t prescaler = 0;
    while (clocks >> prescaler > RELOAD_MAX && prescaler < LARGEST_PRESCALER) {
        prescaler++;
    }
    const uint32_t reload = clocks >> prescaler > RELOAD_MAX ? RELOAD_MAX : clocks >> prescaler;
    epg_stm32_watchdog_freeze();
    iwdg->KR = mine ? KEY_FEED : KEY_START;
    mine = true;
    alone = false;
    wait_for_update(iwdg); /* of an earlier start */
    iwdg->KR = KEY_WRITE;
    iwdg->PR = prescaler;
    iwdg->RLR = reload;
    wait_for_update(iwdg);
    iwdg->KR = KEY_FEED;
}

void EPG_STM32_CYCLE(epg_one_core_watchdog_feed)(void)
{
    if (mine) {
        epg_stm32_watchdog()->KR = KEY_FEED;
    }
}

void epg_one_core_watchdog_stop(void)
{
    epg_one_core_watchdog_feed();
    alone = true;
}

void EPG_STM32_CYCLE(epg_stm32_watchdog_feed_alone)(void)
{
    if (alone) {
        epg_one_core_watchdog_feed();
    }
}

void epg_stm32_watchdog_abandon(void)
{
    alone = false;
}
