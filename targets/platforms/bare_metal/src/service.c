/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Communication on bare metal: an interrupt of lowest priority, so that main() stays the user's.
 *
 * The family's timer asks for it every millisecond, and a transport's interrupt asks for it at once.  All other
 * interrupts, and whatever they do for the user, go before it.
 *
 * It has a stack of its own, so that the user's need not be larger for it.
 */
#include "epg/family.h"

#define PERIOD_US 1000U

/**
 * Bytes that the service takes besides its middleware, with USB's interrupt and the timer's nested in it.  Measured on
 * RP2040 over six runs with USB flooded: 1824 in all with the console.  RP2350 was not measured.
 */
#define SERVICE_AND_INTERRUPTS (256 + 3 * EPG_FAMILY_FPU_FRAME)

/** Bytes, a quarter more than was measured; epg_mcu_status() tells how many are used. */
#ifdef EPG_FAMILY_SERVICE_STACK_SIZE
#define STACK_SIZE EPG_FAMILY_SERVICE_STACK_SIZE
#else
#define STACK_SIZE ((EPG_FAMILY_MIDDLEWARE_STACK + SERVICE_AND_INTERRUPTS) * 5 / 4 / 8 * 8)
#endif

static void (*service)(void);

/* Used from assembler. */
__attribute__((used, aligned(8))) uint32_t epg_mcu_service_memory[STACK_SIZE / sizeof(uint32_t)];

static const epg_mcu_stack_t stack = {
    .bottom = epg_mcu_service_memory,
    .top = epg_mcu_service_memory + STACK_SIZE / sizeof(uint32_t),
};

void epg_mcu_service_wake(void)
{
    if (service != NULL) {
        epg_family_service_pend();
    }
}

__attribute__((used)) void epg_mcu_service_run(void)
{
    void (*const serve)(void) = service;
    if (serve != NULL) {
        serve();
    }
    if (epg_mcu_stack_full(&stack)) {
        epg_family_panic("the stack of communication is too small");
    }
}

/* Runs epg_mcu_service_run() on the service's stack; other interrupts that come meanwhile use it too. */
static void __attribute__((naked)) on_service(void)
{
    __asm__ volatile(".syntax unified\n"
                     "push {r4, r5, r6, lr}\n"
                     "mov r4, sp\n"
                     "ldr r0, =epg_mcu_service_memory\n"
                     "ldr r1, =%c[size]\n"
                     "adds r1, r0, r1\n"
#if __ARM_ARCH >= 8
                     /* Armv8-M checks the stack pointer against a limit. */
                     "mrs r5, msplim\n"
                     "movs r2, #0\n"
                     "msr msplim, r2\n"
                     "mov sp, r1\n"
                     "msr msplim, r0\n"
#else
                     "mov sp, r1\n"
#endif
                     "ldr r0, =epg_mcu_service_run\n"
                     "blx r0\n"
#if __ARM_ARCH >= 8
                     "movs r2, #0\n"
                     "msr msplim, r2\n"
                     "mov sp, r4\n"
                     "msr msplim, r5\n"
#else
                     "mov sp, r4\n"
#endif
                     "pop {r4, r5, r6, pc}\n"
                     ".ltorg\n"
                     :
                     : [size] "i"(STACK_SIZE));
}

bool epg_mcu_service_start(void (*serve)(void))
{
    epg_mcu_stack_paint(stack.bottom, stack.top);
    service = serve;
    if (!epg_family_service_claim(on_service, PERIOD_US)) {
        service = NULL;
        return false;
    }
    return true;
}

bool epg_mcu_service_stop(void)
{
    if (epg_family_in_interrupt()) {
        return false; /* it may have come in the middle of the service, or be the service */
    }
    if (service != NULL) {
        service = NULL; /* from here on nothing asks for it, and an interrupt that was asked for does nothing */
        epg_family_service_release();
    }
    return true;
}

void epg_mcu_service_stack(uint32_t *size, uint32_t *used)
{
    *size = STACK_SIZE;
    *used = epg_mcu_stack_used(&stack, 0);
}
