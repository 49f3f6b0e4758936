/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The program with FreeRTOS: one task obeys the test and computes, another computes, too.
 */
#include <FreeRTOS.h>
#include <task.h>

#include "epg/family.h"
#include "jiwy.h"
#include "program.h"

static StackType_t stacks[2][512];
static StaticTask_t memory[2];

void SysTick_Handler(void);
void xPortSysTickHandler(void);

void SysTick_Handler(void)
{
    systick_calls++;
    xPortSysTickHandler();
}

void hold_basepri(uint32_t milliseconds)
{
    taskENTER_CRITICAL();
    const uint64_t end = mps2_clock() + (uint64_t)milliseconds * 25000U / 16U;
    while (mps2_clock() < end) {
    }
    taskEXIT_CRITICAL();
}

static void run(void *obeys)
{
    for (;;) {
        if (obeys != NULL) {
            orders_obey();
        }
        sums_compute();
    }
}

int main(void)
{
    orders_start();
    sums_compute();
    (void)jiwy_start();
    (void)xTaskCreateStatic(run, "orders", 512, &memory, tskIDLE_PRIORITY + 1, stacks[0], &memory[0]);
    (void)xTaskCreateStatic(run, "sums", 512, NULL, tskIDLE_PRIORITY + 1, stacks[1], &memory[1]);
    vTaskStartScheduler();
    return 1;
}
