/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Hooks, which are functions that the kernel calls: after an error, and when no task is ready.
 *
 * After an error the outputs are made safe first.  The hooks are weak: a definition of the user replaces them.
 */
#include "epg/family.h"
#include "epg/freertos.h"

void vApplicationStackOverflowHook(TaskHandle_t task, char *name);
void vApplicationIdleHook(void);

void __attribute__((weak)) vApplicationStackOverflowHook(TaskHandle_t task, char *name)
{
    (void)task;
    epg_family_panic("stack overflow in task %s", name);
}

/** Sleeps until the next interrupt.  A sleeping core makes no accesses to memory that could delay the control loop. */
void __attribute__((weak)) vApplicationIdleHook(void)
{
    epg_family_sleep();
}

void epg_freertos_assert_failed(const char *file, int line)
{
    epg_family_panic("FreeRTOS: assertion in %s, line %d", file, line);
}
