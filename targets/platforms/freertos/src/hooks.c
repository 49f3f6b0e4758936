/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the kernel calls when something is wrong, outputs first, and when nothing is to be done.  A hook of the user's
 * own takes the place of one here.
 */
#include "../../../families/rp2/src/parts.h"
#include "rtos.h"

void vApplicationStackOverflowHook(TaskHandle_t task, char *name);
void vApplicationIdleHook(void);

void __attribute__((weak)) vApplicationStackOverflowHook(TaskHandle_t task, char *name)
{
    (void)task;
    epg_pico_safe_state();
    panic("stack overflow in task %s", name);
}

/** Core 0 sleeps until an interrupt, and leaves the bus to core 1. */
void __attribute__((weak)) vApplicationIdleHook(void)
{
    __wfi();
}

void epg_freertos_assert_failed(const char *file, int line)
{
    epg_pico_safe_state();
    panic("FreeRTOS: assertion in %s, line %d", file, line);
}
