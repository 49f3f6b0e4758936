/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The interrupt in which the communication side runs on bare metal: a spare interrupt of the chip, which the tick makes
 * pending every millisecond.
 *
 * If the control period is longer than a millisecond, SysTick makes it pending, too.  If the program uses SysTick, its
 * handler stays, and runs first.
 */
#include "epg/one_core.h"

#define LOWEST_PRIORITY ((1U << __NVIC_PRIO_BITS) - 1U)

/** Priority 2 of 16: the user can have more urgent interrupts.  There is no kernel. */
const uint32_t epg_one_core_transport_priority = 2U;

static struct {
    int32_t interrupt;
    epg_one_core_handler_t systick; /* the program's handler; NULL: SysTick is not chained */
    bool systick_is_mine;           /* the program does not use SysTick */
} service;

static void on_systick(void)
{
    if (!service.systick_is_mine) {
        service.systick();
    }
    epg_family_service_pend();
}

static void chain_systick(uint32_t period_us)
{
    service.systick_is_mine = (SysTick->CTRL & SysTick_CTRL_TICKINT_Msk) == 0U;
    service.systick = epg_one_core_set_handler(SysTick_IRQn, on_systick);
    if (service.systick_is_mine) {
        SysTick->LOAD = (uint32_t)((uint64_t)(EPG_ONE_CORE_CORE_HZ)*period_us / 1000000U - 1U);
        SysTick->VAL = 0U;
        NVIC_SetPriority(SysTick_IRQn, LOWEST_PRIORITY);
        SysTick->CTRL = SysTick_CTRL_CLKSOURCE_Msk | SysTick_CTRL_TICKINT_Msk | SysTick_CTRL_ENABLE_Msk;
    }
}

bool epg_family_service_claim(void (*handler)(void), uint32_t period_us)
{
    const IRQn_Type *spare = epg_one_core_spare_interrupts;
    while ((int32_t)*spare >= 0 && NVIC_GetEnableIRQ(*spare) != 0U) {
        spare++;
    }
    service.interrupt = (int32_t)*spare;
    if (service.interrupt < 0) {
        return false;
    }
    epg_one_core_enable(*spare, handler);
    NVIC_SetPriority(*spare, LOWEST_PRIORITY);
    epg_one_core_pend_service(epg_family_service_pend);
    if (epg_one_core_slow()) {
        chain_systick(period_us);
    }
    return true;
}

void EPG_ONE_CORE_CODE epg_family_service_pend(void)
{
    NVIC_SetPendingIRQ((IRQn_Type)service.interrupt);
}

void epg_family_service_release(void)
{
    epg_one_core_pend_service(NULL);
    if (service.systick != NULL) {
        if (service.systick_is_mine) {
            SysTick->CTRL = 0U;
        }
        (void)epg_one_core_set_handler(SysTick_IRQn, service.systick);
        service.systick = NULL;
    }
    epg_one_core_disable((IRQn_Type)service.interrupt);
    NVIC_ClearPendingIRQ((IRQn_Type)service.interrupt);
}
