/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick's timer, and the start of the timers of all outputs in step with it.
 *
 * Timers that the tick's timer can trigger (RM0433, internal trigger connections) are slaves in trigger mode: the start
 * of the tick's counter starts them in hardware, a few clocks of the timers later.  Any other timer gets the counter
 * that belongs to the tick's counter, and is then corrected by what both counters show.  It deviates by the time of one
 * access to a register of a timer, below 0.2 us, and by one count if its clock is divided.
 */
#include "parts.h"

/** The value of MMS that makes the counter's enable bit the trigger output (RM0433, 39.4.2). */
#define TRIGGER_BY_ENABLE TIM_CR2_MMS_0
/** Trigger mode: the rising trigger starts the counter (RM0433, 39.4.3). */
#define START_BY_TRIGGER (TIM_SMCR_SMS_2 | TIM_SMCR_SMS_1)

/* Of the running target. */
static TIM_TypeDef *running EPG_STM32_CYCLE_DATA;
static uint32_t ns_per_count EPG_STM32_CYCLE_DATA; /* times 2^16; 0: a period in ns needs more than 32 bits */

static inline const epg_stm32_timer_t *timer_of(const epg_family_target_t *target)
{
    return epg_stm32_timer(target->tick.timer);
}

/** The index of the input by which `master` can start `timer`, or -1. */
static int32_t link(const epg_stm32_timer_t *timer, uint32_t master)
{
    for (int32_t i = 0; timer->is_trigger && i < 4; i++) {
        if (timer->masters[i] == master) {
            return i;
        }
    }
    return -1;
}

/** The value that the counter of `timer` has if it started together with the tick's, whose counter is `count`. */
static uint32_t in_step(const TIM_TypeDef *timer, const epg_family_target_t *target, uint32_t count)
{
    const uint64_t clocks = (uint64_t)count * target->tick.prescaler;
    const uint32_t counts = (uint32_t)(clocks / (timer->PSC + 1U));
    return counts % (timer->ARR + 1U);
}

static void start_alone(const epg_stm32_timer_t *timer, const epg_family_target_t *target)
{
    TIM_TypeDef *own = timer->registers;
    const TIM_TypeDef *tick = timer_of(target)->registers;
    own->CNT = in_step(own, target, tick->CNT & ~TIM_CNT_UIFCPY);
    own->CR1 |= TIM_CR1_CEN;
    const uint32_t first = tick->CNT & ~TIM_CNT_UIFCPY;
    const uint32_t now = own->CNT;
    const uint32_t second = tick->CNT & ~TIM_CNT_UIFCPY;
    const uint32_t range = own->ARR + 1U;
    const uint32_t wanted = in_step(own, target, first + (second - first) / 2U);
    const uint32_t late = (wanted + range - now) % range;
    own->CNT = (own->CNT + late) % range;
}

IRQn_Type epg_one_core_tick_interrupt(const epg_family_target_t *target)
{
    return timer_of(target)->interrupt;
}

void epg_one_core_tick_start(const epg_family_target_t *target)
{
    const epg_stm32_timer_t *timer = timer_of(target);
    TIM_TypeDef *tick = timer->registers;
    const uint32_t clock = epg_stm32_clock_hz(timer->on_apb2 ? "apb2_timers" : "apb1_timers");
    const uint64_t ns = ((uint64_t)target->tick.prescaler * 1000000000U << 16) / clock;
    running = tick;
    ns_per_count = (ns * (target->tick.top + 1U)) >> 16 < UINT32_MAX ? (uint32_t)ns : 0U;
    epg_stm32_enable_timer(timer);
    tick->CR1 = TIM_CR1_ARPE | TIM_CR1_URS | TIM_CR1_UIFREMAP;
    tick->SMCR = 0U;
    tick->CR2 = TRIGGER_BY_ENABLE;
    tick->PSC = target->tick.prescaler - 1U;
    tick->ARR = target->tick.top;
    tick->EGR = TIM_EGR_UG;
    tick->CNT = 0U;
    tick->SR = 0U;
    tick->DIER = TIM_DIER_UIE;
    *timer->freeze |= timer->freeze_bit;

    uint32_t alone = 0U;
    for (uint32_t number = 0; number < 32U; number++) {
        const epg_stm32_timer_t *output =
            (epg_stm32_output_timers >> number & 1U) != 0U ? epg_stm32_timer(number) : NULL;
        const int32_t input = output == NULL ? -1 : link(output, target->tick.timer);
        if (output == NULL) {
            continue;
        }
        output->registers->CNT = 0U;
        if (input < 0) {
            alone |= 1U << number;
        } else {
            output->registers->SMCR = (uint32_t)input << TIM_SMCR_TS_Pos;
            output->registers->SMCR |= START_BY_TRIGGER;
        }
    }
    const uint32_t before = epg_stm32_enter();
    tick->CR1 |= TIM_CR1_CEN;
    for (uint32_t number = 0; number < 32U; number++) {
        if ((alone >> number & 1U) != 0U) {
            start_alone(epg_stm32_timer(number), target);
        }
    }
    epg_stm32_leave(before);
}

void EPG_STM32_CYCLE(epg_one_core_tick_clear)(const epg_family_target_t *target)
{
    (void)target;
    running->SR = ~TIM_SR_UIF;
    (void)running->SR; /* the write has arrived, so the NVIC does not see the old request again */
    __DSB();
}

uint32_t EPG_STM32_CYCLE(epg_one_core_tick_ns)(const epg_family_target_t *target)
{
    (void)target;
    const uint32_t now = running->CNT; /* bit 31 is a copy of UIF (UIFREMAP), so a further tick is seen at once */
    if ((now & TIM_CNT_UIFCPY) != 0U || ns_per_count == 0U) {
        return EPG_ONE_CORE_TICK_PASSED;
    }
    return (uint32_t)((uint64_t)now * ns_per_count >> 16);
}

void epg_one_core_tick_stop(const epg_family_target_t *target)
{
    TIM_TypeDef *tick = timer_of(target)->registers;
    tick->CR1 = 0U;
    tick->DIER = 0U;
    tick->SR = 0U;
    epg_one_core_outputs_safe();
    epg_stm32_pwm_stop_all();
    epg_stm32_quadrature_stop_all();
}
