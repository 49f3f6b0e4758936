/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the kernel calls when something is wrong, outputs first, and when nothing is to be done.  A hook of the user's
 * own takes the place of one here.
 */
#include "epg/family.h"
#include "rtos.h"

void vApplicationStackOverflowHook(TaskHandle_t task, char *name);
void vApplicationIdleHook(void);

void __attribute__((weak)) vApplicationStackOverflowHook(TaskHandle_t task, char *name)
{
    (void)task;
    epg_family_panic("stack overflow in task %s", name);
}

/** Sleeps until an interrupt, and leaves the bus to the control loop. */
void __attribute__((weak)) vApplicationIdleHook(void)
{
    epg_family_sleep();
}

void epg_freertos_assert_failed(const char *file, int line)
{
    epg_family_panic("FreeRTOS: assertion in %s, line %d", file, line);
}
