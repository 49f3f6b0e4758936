/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * MPS2: the types and constants that `epg/family.h` and `epg/one_core.h` require.
 */
#ifndef EPG_FAMILY_PORT_H
#define EPG_FAMILY_PORT_H

#include "epg/mps2.h"
#include "epg/mps2_device.h"
#include "epg/one_core_port.h"
#include "epg_mps2_target.h"

typedef epg_mps2_target_t epg_family_target_t;

#define EPG_FAMILY_MIDDLEWARE_STACK EPG_MPS2_MIDDLEWARE_STACK
#define EPG_FAMILY_SERVICE_TIMEOUT_MS 500

#define EPG_ONE_CORE_INTERRUPTS MPS2_INTERRUPTS
#define EPG_ONE_CORE_TIME_NS 640 /* 16 clocks */
#define EPG_ONE_CORE_CLOCK_INTERRUPT DUALTIMER_IRQn
#define EPG_ONE_CORE_CORE_HZ MPS2_HZ
#define EPG_ONE_CORE_HOLD_MS 1000

/** Steps of 640 ns since the clock was started. */
uint64_t mps2_clock(void);

static inline uint32_t epg_family_time_us(void)
{
    return (uint32_t)(mps2_clock() * 16U / 25U);
}

#endif
