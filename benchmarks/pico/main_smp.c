/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick is the wrap of a PWM slice.  The FreeRTOS kernel runs on both cores; core 1 only runs one task, which waits
 * for the interrupts of this slice.
 */
#include "FreeRTOS.h"
#include "handwritten.h"
#include "hardware/irq.h"
#include "hardware/pwm.h"
#include "pico/stdlib.h"
#include "task.h"

#define TICK_SLICE 7u
#define TICK_PRESCALER 2u
#define TICK_TOP 62499u

static StaticTask_t memories[2];
static StackType_t stacks[2][1024];
static uint32_t due_us;

static void __attribute__((noinline)) on_tick(void)
{
    pwm_clear_irq(TICK_SLICE);
    due_us += PERIOD_US;
    control_cycle(due_us);
}

static void run_control(void *argument)
{
    (void)argument;
    pwm_set_clkdiv_int_frac(TICK_SLICE, TICK_PRESCALER, 0);
    pwm_set_wrap(TICK_SLICE, TICK_TOP);
    pwm_clear_irq(TICK_SLICE);
    pwm_set_irq_enabled(TICK_SLICE, true);
    irq_set_exclusive_handler(PWM_IRQ_WRAP, on_tick);
    irq_set_priority(PWM_IRQ_WRAP, PICO_HIGHEST_IRQ_PRIORITY);
    irq_set_enabled(PWM_IRQ_WRAP, true); /* in the NVIC of this core only */
    due_us = time_us_32();
    control_start(1u << TICK_SLICE);
    for (;;) {
        __wfi();
    }
}

static void run_communication(void *argument)
{
    (void)argument;
    for (;;) {
        communicate();
        vTaskDelay(1);
    }
}

int main(void)
{
    stdio_init_all();
    TaskHandle_t control =
        xTaskCreateStatic(run_control, "control", 1024, NULL, configMAX_PRIORITIES - 1, stacks[0], &memories[0]);
    TaskHandle_t communication =
        xTaskCreateStatic(run_communication, "communication", 1024, NULL, 2, stacks[1], &memories[1]);
    vTaskCoreAffinitySet(control, 1u << 1);
    vTaskCoreAffinitySet(communication, 1u << 0);
    vTaskStartScheduler();
    return 0;
}
