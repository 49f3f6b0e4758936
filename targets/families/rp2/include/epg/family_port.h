/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * RP2040 and RP2350: the types and constants that `epg/family.h` requires of a family.
 */
#ifndef EPG_FAMILY_PORT_H
#define EPG_FAMILY_PORT_H

#include "epg/pico.h"
#include "epg/pico_sdk.h"
#include "epg_pico_target.h"

typedef epg_pico_target_t epg_family_target_t;

#define EPG_FAMILY_MIDDLEWARE_STACK EPG_PICO_MIDDLEWARE_STACK

#ifdef EPG_PICO_SERVICE_STACK_SIZE
#define EPG_FAMILY_SERVICE_STACK_SIZE EPG_PICO_SERVICE_STACK_SIZE
#endif

/** Milliseconds without a turn of the communication side on core 0 after which the watchdog is no longer fed. */
#ifndef EPG_PICO_CORE0_TIMEOUT_MS
#define EPG_PICO_CORE0_TIMEOUT_MS 500
#endif
#define EPG_FAMILY_SERVICE_TIMEOUT_MS EPG_PICO_CORE0_TIMEOUT_MS

/** Bytes of the FPU's registers in a stack frame: Armv8-M ARM, B3.19.  The RP2040 has no FPU. */
#if PICO_RP2040
#define EPG_FAMILY_FPU_FRAME 0
#else
#define EPG_FAMILY_FPU_FRAME 72
#endif

/* The SDK's panic() makes the outputs safe first, because the linker redirects it (--wrap): safe_state.c. */
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
