/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick is the wrap of a PWM slice.  The slice's counter tells how late a cycle begins, and the timer how many ticks
 * have passed: two wraps before one interrupt look the same as one.
 */
#include "wrap.h"

#include "handwritten.h"
#include "hardware/irq.h"
#include "hardware/pwm.h"
#include "pico/stdlib.h"

#define TICK_SLICE 7u
#define TICK_PRESCALER (SYS_CLK_HZ > 131000000u ? 3u : 2u) /* the counter has 16 bits */
#define TICK_TOP (SYS_CLK_HZ / 1000000u * PERIOD_US / TICK_PRESCALER - 1u)
#define TIMER_US 1u /* resolution of the timer */

static uint32_t due_us;

static void __attribute__((noinline)) on_tick(void)
{
    pwm_clear_irq(TICK_SLICE);
    const uint32_t lateness = pwm_get_counter(TICK_SLICE) * TICK_PRESCALER;
    const uint32_t now_us = time_us_32();
    uint32_t missed = 0;
    due_us += PERIOD_US;
    while ((int32_t)(now_us + TIMER_US - due_us) >= PERIOD_US) {
        due_us += PERIOD_US;
        missed++;
    }
    control_cycle(due_us, lateness, missed);
}

void wrap_start(void)
{
    pwm_set_clkdiv_int_frac(TICK_SLICE, TICK_PRESCALER, 0);
    pwm_set_wrap(TICK_SLICE, TICK_TOP);
    pwm_clear_irq(TICK_SLICE);
    pwm_set_irq_enabled(TICK_SLICE, true);
    irq_set_exclusive_handler(PWM_IRQ_WRAP, on_tick);
    irq_set_priority(PWM_IRQ_WRAP, PICO_HIGHEST_IRQ_PRIORITY);
    irq_set_enabled(PWM_IRQ_WRAP, true); /* in the NVIC of this core only */
    due_us = time_us_32();
    control_start(1u << TICK_SLICE);
}
