/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Time: TIM7 counts microseconds with 16 bits (RM0433, 42).  Its update interrupt counts the wraps.
 *
 * Bit 31 of the counter is a copy of the flag of that interrupt (UIFREMAP).  One read therefore has the counter and a
 * wrap that is not counted yet, also where the interrupt cannot run.
 */
#include "parts.h"
#include "reset.h"

static volatile uint32_t wraps EPG_STM32_CYCLE_DATA;
static bool started EPG_STM32_CYCLE_DATA;

static void EPG_STM32_CYCLE(on_wrap)(void)
{
    TIM7->SR = ~TIM_SR_UIF;
    wraps = wraps + 1U;
    epg_stm32_watchdog_feed_alone();
    (void)TIM7->SR; /* the write has arrived before the interrupt ends */
    __DSB();
}

bool epg_stm32_time_start(void)
{
    const epg_stm32_timer_t *timer = epg_stm32_timer(7);
    if (started) {
        return true;
    }
    if ((*timer->enable & timer->enable_bit) != 0U && (TIM7->CR1 & TIM_CR1_CEN) != 0U) {
        return false;
    }
    epg_stm32_enable_timer(timer);
    TIM7->CR1 = TIM_CR1_URS | TIM_CR1_UIFREMAP;
    TIM7->PSC = epg_stm32_clock_hz("apb1_timers") / 1000000U - 1U;
    TIM7->ARR = 0xFFFFU;
    TIM7->EGR = TIM_EGR_UG; /* takes the prescaler over */
    TIM7->SR = 0U;
    TIM7->DIER = TIM_DIER_UIE;
    (void)epg_one_core_set_handler(TIM7_IRQn, on_wrap);
    NVIC_SetPriority(TIM7_IRQn, 0U);
    NVIC_ClearPendingIRQ(TIM7_IRQn);
    NVIC_EnableIRQ(TIM7_IRQn);
    *timer->freeze |= timer->freeze_bit;
    TIM7->CR1 |= TIM_CR1_CEN;
    started = true;
    return true;
}

uint64_t EPG_STM32_CYCLE(epg_stm32_time_us)(void)
{
    if (!started) {
        return 0U;
    }
    uint32_t counted = wraps;
    uint32_t now = TIM7->CNT;
    if (wraps != counted) {
        counted = wraps; /* the interrupt came in between; it comes every 65 ms, so not again */
        now = TIM7->CNT;
    }
    const uint64_t high = (uint64_t)counted + (now >> TIM_CNT_UIFCPY_Pos);
    return high << 16 | (now & 0xFFFFU);
}

uint64_t EPG_STM32_CYCLE(epg_one_core_time_ns)(void)
{
    const uint64_t us = epg_stm32_time_us();
    /* In two parts: one multiplication instead of many shifts. */
    return (uint64_t)(uint32_t)us * 1000U + ((uint64_t)((uint32_t)(us >> 32) * 1000U) << 32);
}
