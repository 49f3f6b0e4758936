/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Arbitration of core 1: the control loop has it while a target runs; at other times the program may use it.
 *
 * The linker redirects the program's calls of the SDK's functions for core 1 to the functions here (--wrap).  A target
 * does not start while the program uses core 1, and the program cannot use core 1 while a target runs.
 */
#include "parts.h"

void __real_multicore_launch_core1_raw(void (*entry)(void), uint32_t *stack, uint32_t vector_table);

void __wrap_multicore_reset_core1(void);
void __wrap_multicore_launch_core1(void (*entry)(void));
void __wrap_multicore_launch_core1_with_stack(void (*entry)(void), uint32_t *bottom, size_t size);
void __wrap_multicore_launch_core1_raw(void (*entry)(void), uint32_t *stack, uint32_t vector_table);

static bool taken;

bool epg_pico_core1_taken(void)
{
    return taken;
}

/** True if the program may use core 1 now. */
static bool granted(void)
{
    if (epg_pico_control_runs()) {
        epg_mcu_report(EPG_PICO_ERROR_CORE_TAKEN);
        return false;
    }
    return true;
}

void __wrap_multicore_reset_core1(void)
{
    if (granted()) {
        __real_multicore_reset_core1();
        taken = false;
    }
}

/** The program's code on core 1 runs on the control loop's stack, which is not in use then. */
void __wrap_multicore_launch_core1(void (*entry)(void))
{
    const epg_mcu_stack_t *stack = &epg_family_control_stack;
    __wrap_multicore_launch_core1_with_stack(entry, stack->bottom,
                                             (size_t)(stack->top - stack->bottom) * sizeof *stack->bottom);
}

void __wrap_multicore_launch_core1_with_stack(void (*entry)(void), uint32_t *bottom, size_t size)
{
    if (granted()) {
        taken = true;
        __real_multicore_launch_core1_with_stack(entry, bottom, size);
    }
}

void __wrap_multicore_launch_core1_raw(void (*entry)(void), uint32_t *stack, uint32_t vector_table)
{
    if (granted()) {
        taken = true;
        __real_multicore_launch_core1_raw(entry, stack, vector_table);
    }
}
