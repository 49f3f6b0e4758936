/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that programs call on a Pico, and the limits of core 0's stack.
 */
#include "parts.h"

/* Defined by the SDK's linker scripts. */
extern uint32_t __StackBottom;
extern uint32_t __StackTop;

const epg_mcu_stack_t epg_family_main_stack = {.bottom = &__StackBottom, .top = &__StackTop};

bool epg_pico_start(const epg_pico_target_t *pico)
{
    return epg_mcu_start(pico);
}

bool epg_pico_stop(void)
{
    return epg_mcu_stop();
}

void epg_pico_status(epg_pico_status_t *status)
{
    epg_mcu_status(status);
}
