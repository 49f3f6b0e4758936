/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32: the types and constants that `epg/family.h` and `epg/one_core.h` require of a family.
 */
#ifndef EPG_FAMILY_PORT_H
#define EPG_FAMILY_PORT_H

#include "epg/stm32.h"
#include "epg/stm32_device.h"
#include "epg_stm32_interrupts.h"
#include "epg_stm32_target.h"

typedef epg_stm32_target_t epg_family_target_t;

#define EPG_FAMILY_MIDDLEWARE_STACK EPG_STM32_MIDDLEWARE_STACK

#ifdef EPG_STM32_SERVICE_STACK_SIZE
#define EPG_FAMILY_SERVICE_STACK_SIZE EPG_STM32_SERVICE_STACK_SIZE
#endif

/** Milliseconds without a turn of the communication side after which the watchdog is no longer fed. */
#ifndef EPG_STM32_SERVICE_TIMEOUT_MS
#define EPG_STM32_SERVICE_TIMEOUT_MS 500
#endif
#define EPG_FAMILY_SERVICE_TIMEOUT_MS EPG_STM32_SERVICE_TIMEOUT_MS

/** Number of interrupts, from ST's header. */
#define EPG_ONE_CORE_INTERRUPTS EPG_STM32_INTERRUPTS

/** Milliseconds of the longest write to flash, with the erasure of a sector: 4 s at most (DS12110 and DS11532). */
#define EPG_ONE_CORE_HOLD_MS 6000

/** Resolution of epg_one_core_time_ns(): TIM7 counts microseconds. */
#define EPG_ONE_CORE_TIME_NS 1000

/** The interrupt of the timer behind epg_one_core_time_ns(). */
#define EPG_ONE_CORE_CLOCK_INTERRUPT TIM7_IRQn

/** The clock of the core in Hz, read from registers. */
#define EPG_ONE_CORE_CORE_HZ (epg_stm32_clock_hz("core"))
uint32_t epg_stm32_clock_hz(const char *name);

/** EPG's linker script has tightly coupled memory for these sections. */
#define EPG_ONE_CORE_CODE __attribute__((section(".text.epg_cycle")))
#define EPG_ONE_CORE_DATA __attribute__((section(".bss.epg_cycle")))

#include "epg/one_core_port.h"

/** Microseconds by TIM7 since the first start of a target. */
uint64_t epg_stm32_time_us(void);

static inline uint32_t epg_family_time_us(void)
{
    return (uint32_t)epg_stm32_time_us();
}

#endif
