/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that programs call on a Pico, the conditions of a start, and the limits of core 0's stack.
 */
#include "parts.h"

/* Defined by the SDK's linker scripts. */
extern uint32_t __StackBottom;
extern uint32_t __StackTop;

const epg_mcu_stack_t epg_family_main_stack = {.bottom = &__StackBottom, .top = &__StackTop};

epg_mcu_error_t epg_family_check_start(const epg_family_target_t *pico)
{
    if (epg_pico_core1_taken()) {
        return EPG_MCU_ERROR_CORE_TAKEN;
    }
    const bool right =
        epg_mcu_check_clock("clk_sys", pico->clock, clock_get_hz(clk_sys)) &&
        (pico->uart_clock == 0U || epg_mcu_check_clock("clk_peri", pico->uart_clock, clock_get_hz(clk_peri)));
    return right ? EPG_MCU_OK : EPG_MCU_ERROR_CLOCK;
}

/** The control cycle has a core of its own, which the program cannot use while the target runs (core1.c). */
void epg_family_check_running(void)
{
}

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

const epg_mcu_clock_t *epg_pico_wrong_clock(void)
{
    return epg_mcu_wrong_clock();
}
