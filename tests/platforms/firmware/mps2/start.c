/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The table of vectors, and the start of a program: variables, floating-point unit, main().
 */
#include "board.h"

#include <string.h>

extern unsigned char data_begin[], data_end[], data_image[], bss_begin[], bss_end[], stack_end[];

int main(void);
void reset_handler(void);

/** A fault or an interrupt that the program does not expect. */
static void unexpected(void)
{
    for (;;) {
    }
}

#define HANDLER(name) void name(void) __attribute__((weak, alias("unexpected")))
HANDLER(hard_fault_handler);
HANDLER(SVC_Handler); /* FreeRTOS has these three */
HANDLER(PendSV_Handler);
HANDLER(SysTick_Handler);
HANDLER(uart0_handler);
HANDLER(uart1_handler);
HANDLER(uart2_handler);
HANDLER(timer0_handler);
HANDLER(timer1_handler);

typedef union vector {
    void *stack;
    void (*handler)(void);
} vector_t;

extern const vector_t vectors[16 + IRQS];
__attribute__((section(".vectors"), used)) const vector_t vectors[16 + IRQS] = {
    [0] = {.stack = stack_end},
    [1] = {.handler = reset_handler},
    [2] = {.handler = unexpected},
    [3] = {.handler = hard_fault_handler},
    [4] = {.handler = unexpected},
    [5] = {.handler = unexpected},
    [6] = {.handler = unexpected},
    [11] = {.handler = SVC_Handler},
    [14] = {.handler = PendSV_Handler},
    [15] = {.handler = SysTick_Handler},
    [16 + IRQ_UART0] = {.handler = uart0_handler},
    [16 + IRQ_UART1] = {.handler = uart1_handler},
    [16 + IRQ_UART2] = {.handler = uart2_handler},
    [16 + IRQ_TIMER0] = {.handler = timer0_handler},
    [16 + IRQ_TIMER1] = {.handler = timer1_handler},
};

void reset_handler(void)
{
#ifdef __ARM_FP
    CPACR |= 0xFU << 20;
    __asm volatile("dsb\n isb" ::: "memory");
#endif
    memcpy(data_begin, data_image, (size_t)(data_end - data_begin));
    memset(bss_begin, 0, (size_t)(bss_end - bss_begin));
    (void)main();
    unexpected();
}
