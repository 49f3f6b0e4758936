/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * RP2040 and RP2350 for the platforms: what `epg/family.h` asks of a family's header.
 */
#ifndef EPG_FAMILY_PORT_H
#define EPG_FAMILY_PORT_H

#include "../../src/sdk.h"
#include "epg/pico.h"
#include "epg_pico_target.h"

typedef epg_pico_target_t epg_family_target_t;

#define EPG_FAMILY_MIDDLEWARE_STACK EPG_PICO_MIDDLEWARE_STACK

#ifdef EPG_PICO_SERVICE_STACK_SIZE
#define EPG_FAMILY_SERVICE_STACK_SIZE EPG_PICO_SERVICE_STACK_SIZE
#endif

/** Milliseconds in which core 0 must have served communication once. */
#ifndef EPG_PICO_CORE0_TIMEOUT_MS
#define EPG_PICO_CORE0_TIMEOUT_MS 500
#endif
#define EPG_FAMILY_SERVICE_TIMEOUT_MS EPG_PICO_CORE0_TIMEOUT_MS

/** Armv8-M ARM, B3.19; the RP2040 has no FPU. */
#if PICO_RP2040
#define EPG_FAMILY_FPU_FRAME 0
#else
#define EPG_FAMILY_FPU_FRAME 72
#endif

/** The head has the last page of a sector: flash.c. */
#define EPG_FAMILY_STORE_CAPACITY (4096U - 256U)

/* The linker leads panic() through epg_pico_safe_state(): safe_state.c. */
#define epg_family_panic panic
#define epg_family_sleep __wfi

static inline bool epg_family_in_interrupt(void)
{
    return __get_current_exception() != 0U;
}

static inline uint32_t epg_family_time_us(void)
{
    return timer_hw->timerawl;
}

#endif
