/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Faults of the processor: the outputs are made safe before any other code runs.
 *
 * MemManage, BusFault and UsageFault become a HardFault unless the program has enabled them, so all four have the same
 * handler.  It ends control: also if the user's handler returns, no further cycle writes outputs, and the watchdog is no
 * longer fed.  The watchdog then resets the chip.  After a reset, the fault is reported.
 */
#include <stdarg.h>

#include "epg/one_core.h"

/** Words of the handler's own stack: the present stack may have overflowed. */
#define EMERGENCY_STACK 128

/** Numbers of the exceptions: Armv7-M ARM, B1.5.2. */
#define HARD_FAULT 3
#define USAGE_FAULT 6

/* Used from assembler: the stack, and the handlers that were installed before, by the number of the exception. */
__attribute__((used, aligned(8))) uint32_t epg_one_core_emergency_stack[EMERGENCY_STACK] EPG_ONE_CORE_DATA;
__attribute__((used)) epg_one_core_handler_t epg_one_core_next_handlers[USAGE_FAULT + 1] EPG_ONE_CORE_DATA;

/** Bits of CFSR: the core could not save registers on a stack (B3.2.15). */
#define STACK_IS_BAD (SCB_CFSR_STKERR_Msk | SCB_CFSR_MSTKERR_Msk)
/** Bit of EXC_RETURN: that stack is the one of PSP (B1.5.8). */
#define IS_PROCESS_STACK 4U

static void EPG_ONE_CORE_CODE end_run(void)
{
    epg_one_core_end(); /* first: below the tick, as in a panic, the next cycle would write the outputs again */
    epg_one_core_outputs_safe();
    epg_one_core_remember_fault();
}

void epg_one_core_on_fault(uint32_t exc_return);

__attribute__((used)) void EPG_ONE_CORE_CODE epg_one_core_on_fault(uint32_t exc_return)
{
    end_run();
    if ((exc_return & IS_PROCESS_STACK) == 0U && (SCB->CFSR & STACK_IS_BAD) != 0U) {
        NVIC_SystemReset(); /* the user's handler would need that stack */
    }
}

/*
 * Switches to the emergency stack, calls epg_one_core_on_fault(), restores the stack pointer and LR, and jumps to the
 * handler that was installed before.  That handler finds the exception as it was.  If the main stack is bad, it is not
 * called.
 */
static void __attribute__((naked)) EPG_ONE_CORE_CODE on_fault(void)
{
    __asm__ volatile(".syntax unified\n"
                     "mov r2, sp\n"
                     "mov r3, lr\n"
                     "ldr r1, =epg_one_core_emergency_stack\n"
                     "add r1, r1, #%c[size]\n"
                     "mov sp, r1\n"
                     "push {r2, r3}\n"
                     "mov r0, lr\n"
                     "ldr r1, =epg_one_core_on_fault\n"
                     "blx r1\n"
                     "pop {r2, r3}\n"
                     "mov sp, r2\n"
                     "mov lr, r3\n"
                     "mrs r0, ipsr\n"
                     "ldr r1, =epg_one_core_next_handlers\n"
                     "ldr r0, [r1, r0, lsl #2]\n"
                     "bx r0\n"
                     ".ltorg\n"
                     :
                     : [size] "i"(EMERGENCY_STACK * 4));
}

void epg_family_guard_faults(void)
{
    for (int32_t exception = HARD_FAULT; exception <= USAGE_FAULT; exception++) {
        const epg_one_core_handler_t before = epg_one_core_set_handler((IRQn_Type)(exception - 16), on_fault);
        if (before != on_fault) {
            epg_one_core_next_handlers[exception] = before;
        }
    }
}

void epg_one_core_panic(const char *format, ...)
{
    (void)format; /* for the debugger */
    end_run();
    for (;;) {
        if ((CoreDebug->DHCSR & CoreDebug_DHCSR_C_DEBUGEN_Msk) != 0U) {
            __BKPT(0);
        }
    }
}
