/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * PWM outputs (RM0433, 38.3.11 and 39.3.9).  The counters start in tick.c.
 */
#include "epg/port.h"

#include "parts.h"

/** PWM mode 1 with preload, in the field of a channel in CCMR1 or CCMR2 (RM0433, 38.4.7). */
#define PWM_MODE (TIM_CCMR1_OC1M_2 | TIM_CCMR1_OC1M_1 | TIM_CCMR1_OC1PE)
#define CHANNEL_MASK (TIM_CCMR1_OC1M | TIM_CCMR1_OC1PE | TIM_CCMR1_OC1FE | TIM_CCMR1_OC1CE | TIM_CCMR1_CC1S)

#define TIMERS 18U

uint32_t epg_stm32_output_timers;

/* By the index of the instance in the chip's data. */
static TIM_TypeDef *outputs[TIMERS] EPG_STM32_CYCLE_DATA;

void epg_port_pwm_start(const epg_port_pwm_t *pwm)
{
    const uint32_t number = epg_stm32_hardware.timers[pwm->instance];
    const epg_stm32_timer_t *timer = epg_stm32_timer(number);
    TIM_TypeDef *registers = timer->registers;
    outputs[pwm->instance] = registers;
    epg_stm32_enable_timer(timer);
    if ((epg_stm32_output_timers >> number & 1U) == 0U) {
        if ((registers->CR1 & TIM_CR1_CEN) != 0U) {
            epg_stm32_resource_taken = true;
            return;
        }
        registers->CR1 = TIM_CR1_ARPE | TIM_CR1_URS;
        registers->CR2 = 0U;
        registers->SMCR = 0U;
        registers->DIER = 0U;
        registers->CCER = 0U;
        registers->CCMR1 = 0U;
        registers->CCMR2 = 0U;
        epg_stm32_output_timers |= 1U << number;
    }
    registers->PSC = pwm->prescaler - 1U;
    registers->ARR = pwm->top;
    epg_port_pwm_write(pwm, 0U);
    volatile uint32_t *mode = pwm->slot < 2U ? &registers->CCMR1 : &registers->CCMR2;
    const uint32_t shift = 8U * (pwm->slot & 1U);
    *mode = (*mode & ~(CHANNEL_MASK << shift)) | PWM_MODE << shift;
    registers->CCER |= TIM_CCER_CC1E << (4U * pwm->slot);
    registers->EGR = TIM_EGR_UG; /* takes prescaler, top and level over */
    if (timer->has_break) {
        registers->BDTR = TIM_BDTR_OSSI | TIM_BDTR_OSSR | TIM_BDTR_MOE; /* no break input */
    }
    epg_stm32_connect(pwm->pin, EPG_PULL_NONE);
}

void EPG_STM32_CYCLE(epg_port_pwm_write)(const epg_port_pwm_t *pwm, uint32_t level)
{
    (&outputs[pwm->instance]->CCR1)[pwm->slot] = level;
}

void epg_stm32_pwm_stop_all(void)
{
    for (uint32_t number = 0; number < 32U; number++) {
        if ((epg_stm32_output_timers >> number & 1U) != 0U) {
            const epg_stm32_timer_t *timer = epg_stm32_timer(number);
            if (timer->has_break) {
                timer->registers->BDTR = TIM_BDTR_OSSI | TIM_BDTR_OSSR;
            }
            timer->registers->CR1 = 0U;
            timer->registers->SMCR = 0U;
            timer->registers->CCER = 0U;
        }
    }
    epg_stm32_output_timers = 0U;
}
