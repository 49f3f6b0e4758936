/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Communication on bare metal: an interrupt of lowest priority on core 0, so that main() stays the user's.
 *
 * A hardware alarm of its own (not the SDK's alarm pool) asks for it every millisecond, and a transport's interrupt
 * asks for it at once.  All other interrupts, and whatever they do for the user, go before it.
 *
 * It has a stack of its own, so that the user's need not be larger for it.
 */
#include "../../../families/rp2/src/parts.h"

#define PERIOD_US 1000U

/**
 * Bytes that the service takes besides its middleware, with USB's interrupt and the alarm's nested in it.  Measured on
 * RP2040 over six runs with USB flooded: 1824 in all with the console.  RP2350 was not measured.
 */
#define SERVICE_AND_INTERRUPTS (256 + 3 * EPG_PICO_FPU_FRAME)

/** Bytes, a quarter more than was measured; epg_pico_status() tells how many are used. */
#ifndef EPG_PICO_SERVICE_STACK_SIZE
#define EPG_PICO_SERVICE_STACK_SIZE ((EPG_PICO_MIDDLEWARE_STACK + SERVICE_AND_INTERRUPTS) * 5 / 4 / 8 * 8)
#endif

static struct {
    void (*serve)(void);
    uint irq;
    uint alarm;
} service;

/* Used from assembler. */
__attribute__((used, aligned(8))) uint32_t epg_pico_service_memory[EPG_PICO_SERVICE_STACK_SIZE / sizeof(uint32_t)];

static const epg_pico_stack_t stack = {
    .bottom = epg_pico_service_memory,
    .top = epg_pico_service_memory + EPG_PICO_SERVICE_STACK_SIZE / sizeof(uint32_t),
};

/** Asks for the service, from any interrupt of core 0. */
void epg_pico_service_wake(void)
{
    if (service.serve != NULL) {
        irq_set_pending(service.irq);
    }
}

__attribute__((used)) void epg_pico_service_run(void)
{
    service.serve();
    if (epg_pico_stack_full(&stack)) {
        panic("EPG_PICO_SERVICE_STACK_SIZE is too small");
    }
}

/* Runs epg_pico_service_run() on the service's stack; other interrupts that come meanwhile use it too. */
static void __attribute__((naked)) on_service(void)
{
    pico_default_asm_volatile("push {r4, r5, r6, lr}\n"
                              "mov r4, sp\n"
                              "ldr r0, =epg_pico_service_memory\n"
                              "ldr r1, =%c[size]\n"
                              "adds r1, r0, r1\n"
#if !PICO_RP2040
                              /* Armv8-M checks the stack pointer against a limit. */
                              "mrs r5, msplim\n"
                              "movs r2, #0\n"
                              "msr msplim, r2\n"
                              "mov sp, r1\n"
                              "msr msplim, r0\n"
#else
                              "mov sp, r1\n"
#endif
                              "ldr r0, =epg_pico_service_run\n"
                              "blx r0\n"
#if !PICO_RP2040
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
                              : [size] "i"(EPG_PICO_SERVICE_STACK_SIZE));
}

/** Next time in whole periods from the present one: it may have passed already when an interrupt came in between. */
static void set_alarm(void)
{
    absolute_time_t next = make_timeout_time_us(PERIOD_US);
    for (int attempt = 0; attempt < 8 && hardware_alarm_set_target(service.alarm, next); attempt++) {
        next = make_timeout_time_us(PERIOD_US << attempt);
    }
}

static void on_alarm(uint alarm)
{
    (void)alarm;
    epg_pico_service_wake();
    set_alarm();
}

bool epg_pico_service_start(void (*serve)(void))
{
    const int alarm = hardware_alarm_claim_unused(false);
    const int irq = user_irq_claim_unused(false);
    if (alarm < 0 || irq < 0) {
        if (alarm >= 0) {
            hardware_alarm_unclaim((uint)alarm);
        }
        if (irq >= 0) {
            user_irq_unclaim((uint)irq);
        }
        return false;
    }
    epg_pico_stack_paint(stack.bottom, stack.top);
    service.serve = serve;
    service.alarm = (uint)alarm;
    service.irq = (uint)irq;
    irq_set_exclusive_handler(service.irq, on_service);
    irq_set_priority(service.irq, PICO_LOWEST_IRQ_PRIORITY);
    irq_set_enabled(service.irq, true);
    hardware_alarm_set_callback(service.alarm, on_alarm);
    set_alarm();
    return true;
}

bool epg_pico_service_stop(void)
{
    if (__get_current_exception() != 0U) {
        return false; /* an interrupt: it may have come in the middle of the service, or be the service */
    }
    if (service.serve != NULL) {
        irq_set_enabled(service.irq, false);
        service.serve = NULL;
        hardware_alarm_set_callback(service.alarm, NULL);
        hardware_alarm_unclaim(service.alarm);
        irq_remove_handler(service.irq, on_service);
        user_irq_unclaim(service.irq);
    }
    return true;
}

void epg_pico_service_stack(uint32_t *size, uint32_t *used)
{
    *size = EPG_PICO_SERVICE_STACK_SIZE;
    *used = epg_pico_stack_used(&stack, 0);
}
