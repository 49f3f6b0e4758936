/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Looks for interrupts that could delay the tick.
 *
 * An interrupt of the tick's priority that runs already delays the tick until it ends.  Projects of STM32CubeMX often
 * leave all priorities at 0, the highest.  The registers are described in Armv7-M ARM, B3.2 (SCB, SysTick) and B3.4.
 */
#include "control.h"

/** The bits of an 8-bit priority that decide whether an interrupt can interrupt another one (B1.5.4). */
static uint32_t preemption_mask(void)
{
    const uint32_t group = (SCB->AIRCR & SCB_AIRCR_PRIGROUP_Msk) >> SCB_AIRCR_PRIGROUP_Pos;
    return 0xFFU & ~((2U << group) - 1U);
}

static bool could_delay(IRQn_Type interrupt, uint32_t mask)
{
    return ((NVIC_GetPriority(interrupt) << (8U - __NVIC_PRIO_BITS)) & mask) == 0U;
}

static epg_mcu_priority_t named(int32_t interrupt, const char *name)
{
    const char *known = name != NULL ? name : epg_one_core_interrupt_name(interrupt);
    return (epg_mcu_priority_t){.name = known != NULL ? known : "an interrupt", .interrupt = interrupt};
}

epg_mcu_priority_t epg_one_core_check_priorities(void)
{
    const uint32_t mask = preemption_mask();
    if ((mask & (1U << (8U - __NVIC_PRIO_BITS))) == 0U) {
        return named(-16, "PRIGROUP"); /* priorities 0 and 1 could not interrupt each other */
    }
    if ((SysTick->CTRL & SysTick_CTRL_TICKINT_Msk) != 0U && could_delay(SysTick_IRQn, mask)) {
        return named(-1, "SysTick");
    }
    for (uint32_t word = 0; word * 32U < EPG_ONE_CORE_INTERRUPTS; word++) {
        uint32_t enabled = NVIC->ISER[word];
        while (enabled != 0U) { /* at most 32 times: each turn clears a bit */
            const uint32_t bit = 31U - (uint32_t)__CLZ(enabled);
            enabled &= ~(1U << bit);
            const int32_t interrupt = (int32_t)(word * 32U + bit);
            if (interrupt != (int32_t)EPG_ONE_CORE_CLOCK_INTERRUPT && interrupt != epg_one_core_tick_in_use() &&
                could_delay((IRQn_Type)interrupt, mask)) {
                return named(interrupt, NULL);
            }
        }
    }
    return (epg_mcu_priority_t){0};
}
