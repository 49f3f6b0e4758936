/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick is the wrap of a PWM slice.  The FreeRTOS kernel runs on both cores; core 1 only runs one task, which waits
 * for the interrupts of this slice.
 */
#include "FreeRTOS.h"
#include "handwritten.h"
#include "pico/stdlib.h"
#include "task.h"
#include "wrap.h"

static StaticTask_t memories[2];
static StackType_t stacks[2][1024];

static void run_control(void *argument)
{
    (void)argument;
    wrap_start();
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
