/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that programs call on an STM32, the conditions of a start, and the limits of the main stack.
 */
#include "parts.h"

/* Defined by stack.ld. */
extern uint32_t epg_stm32_stack_bottom;
extern uint32_t epg_stm32_stack_top;

const epg_mcu_stack_t epg_family_main_stack = {.bottom = &epg_stm32_stack_bottom, .top = &epg_stm32_stack_top};

bool epg_stm32_resource_taken;

uint32_t EPG_STM32_CYCLE(epg_stm32_enter)(void)
{
    const uint32_t before = __get_BASEPRI();
    __set_BASEPRI_MAX(1U << (8U - __NVIC_PRIO_BITS));
    __ISB();
    return before;
}

void EPG_STM32_CYCLE(epg_stm32_leave)(uint32_t before)
{
    __set_BASEPRI(before);
}

void epg_stm32_enable_timer(const epg_stm32_timer_t *timer)
{
    const uint32_t before = epg_stm32_enter();
    *timer->enable |= timer->enable_bit;
    (void)*timer->enable; /* RM0433, 8.5.11: the clock is there after a delay of two clocks; a read waits for it */
    epg_stm32_leave(before);
}

epg_mcu_error_t epg_family_check_start(const epg_family_target_t *target)
{
    for (size_t i = 0; i < target->clock_count; i++) {
        const epg_stm32_clock_t *clock = &target->clocks[i];
        if (!epg_mcu_check_clock(clock->name, clock->hz, epg_stm32_clock_hz(clock->name))) {
            return EPG_MCU_ERROR_CLOCK;
        }
    }
    uint32_t limit_hz;
    const char *limit = epg_stm32_core_limit(&limit_hz);
    if (limit != NULL) {
        (void)epg_mcu_check_clock(limit, limit_hz, epg_stm32_clock_hz("core"));
        return EPG_MCU_ERROR_CLOCK;
    }
    return epg_stm32_time_start() ? EPG_MCU_OK : EPG_MCU_ERROR_RESOURCE;
}

bool epg_one_core_resources_free(void)
{
    const bool is_free = !epg_stm32_resource_taken;
    epg_stm32_resource_taken = false;
    return is_free;
}

#define NAME(number, name) [number] = #name,

const char *epg_one_core_interrupt_name(int32_t interrupt)
{
    static const char *const names[EPG_STM32_INTERRUPTS] = {EPG_STM32_EACH_INTERRUPT(NAME)};
    return interrupt >= 0 && interrupt < EPG_STM32_INTERRUPTS ? names[interrupt] : NULL;
}

bool epg_stm32_start(const epg_stm32_target_t *target)
{
    return epg_mcu_start(target);
}

bool epg_stm32_stop(void)
{
    return epg_mcu_stop();
}

void epg_stm32_status(epg_stm32_status_t *status)
{
    epg_mcu_status(status);
}

const epg_mcu_clock_t *epg_stm32_wrong_clock(void)
{
    return epg_mcu_wrong_clock();
}

void epg_stm32_safe_state(void)
{
    epg_one_core_outputs_safe();
}
