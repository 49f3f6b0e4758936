/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick: TIMER0.
 */
#include "epg/one_core.h"

IRQn_Type epg_one_core_tick_interrupt(const epg_family_target_t *target)
{
    (void)target;
    return TIMER0_IRQn;
}

void epg_one_core_tick_start(const epg_family_target_t *target)
{
    TIMER0->ctrl = 0U;
    TIMER0->interrupt = 1U;
    TIMER0->reload = target->top;
    TIMER0->value = target->top;
    TIMER0->ctrl = 9U;
}

void epg_one_core_tick_clear(const epg_family_target_t *target)
{
    (void)target;
    TIMER0->interrupt = 1U;
    __DSB();
}

uint32_t epg_one_core_tick_ns(const epg_family_target_t *target)
{
    const uint32_t value = TIMER0->value;
    if (TIMER0->interrupt != 0U) {
        return EPG_ONE_CORE_TICK_PASSED;
    }
    const uint32_t since = value == 0U ? 0U : target->top + 1U - value; /* the request is at 0 */
    return since * (1000000000U / MPS2_HZ);
}

void epg_one_core_tick_stop(const epg_family_target_t *target)
{
    (void)target;
    TIMER0->ctrl = 0U;
    TIMER0->interrupt = 1U;
}

bool epg_one_core_resources_free(void)
{
    return true;
}
