/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A program with FreeRTOS: turns in a task, which sleeps until a byte arrives, at most one millisecond.
 *
 * The interrupt of the control cycle is above the priorities that the kernel masks, so the kernel never delays it.
 */
#include <FreeRTOS.h>
#include <task.h>

#include "line.h"
#include "program.h"

static StackType_t stack[2048];
static StaticTask_t memory;
static TaskHandle_t task;

void line_received(void)
{
    BaseType_t woken = pdFALSE;
    if (task != NULL) {
        vTaskNotifyGiveFromISR(task, &woken);
    }
    portYIELD_FROM_ISR(woken);
}

static void run(void *context)
{
    (void)context;
    program_start();
    for (;;) {
        program_turn();
        (void)ulTaskNotifyTake(pdTRUE, pdMS_TO_TICKS(1));
    }
}

int main(void)
{
    task = xTaskCreateStatic(run, "communication", sizeof stack / sizeof stack[0], NULL, 1, stack, &memory);
    vTaskStartScheduler();
    return 1;
}
