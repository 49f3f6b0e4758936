/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The communication side on bare metal: an interrupt of the lowest priority, called the service here.
 *
 * Without an RTOS there are no tasks.  The service runs beside main() because it is an interrupt, so main() belongs to
 * the user.  All other interrupts can interrupt it, the user's too.
 *
 * The service runs at least every millisecond, started by the family's timer, and as soon as possible after a transport's
 * interrupt.
 *
 * It has its own stack.  The user's main stack need not be larger because of it.
 */
#include "epg/family.h"

/** From one turn to the next is at most a millisecond; interrupts can delay a turn by the rest. */
#define PERIOD_US 950U

/**
 * Bytes of stack for the service itself and for the interrupts of USB and of the timer, which can interrupt it.  The
 * middleware's bytes are added.  Measured on RP2040 in six runs with USB flooded: 1824 bytes in all with the console.
 * RP2350 was not measured.
 */
#define SERVICE_AND_INTERRUPTS (256 + 3 * EPG_FAMILY_FPU_FRAME)

/** Bytes of the stack: a quarter more than was measured.  epg_mcu_status() reports how many have been used. */
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

/*
 * Entry of the interrupt: switches to the service's stack, calls epg_mcu_service_run(), and switches back.  Interrupts
 * that interrupt the service use its stack, too.
 */
static void __attribute__((naked)) on_service(void)
{
    __asm__ volatile(".syntax unified\n"
                     "push {r4, r5, r6, lr}\n"
                     "mov r4, sp\n"
                     "ldr r0, =epg_mcu_service_memory\n"
                     "ldr r1, =%c[size]\n"
                     "adds r1, r0, r1\n"
#if __ARM_ARCH >= 8
                     /*
                      * Armv8-M compares the stack pointer with the limit in MSPLIM.  A limit of 0 permits the switch.
                      */
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
    if (!epg_family_service_claim(on_service, PERIOD_US)) {
        return false;
    }
    service = serve; /* last: a transport that wakes the service earlier would pend an interrupt that is not claimed */
    return true;
}

bool epg_mcu_service_stop(void)
{
    if (epg_family_in_interrupt()) {
        return false; /* the interrupt may have interrupted the service, or may be the service */
    }
    if (service != NULL) {
        service = NULL; /* no more wake-ups; a service interrupt that is pending already does nothing */
        epg_family_service_release();
    }
    return true;
}

void epg_mcu_service_stack(uint32_t *size, uint32_t *used)
{
    *size = STACK_SIZE;
    *used = epg_mcu_stack_used(&stack, 0);
}
