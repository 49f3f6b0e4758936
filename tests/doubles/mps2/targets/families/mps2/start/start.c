/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The table of vectors of the program, and its start.
 */
#include <string.h>

#include "epg/one_core.h"

extern unsigned char data_begin[], data_end[], data_image[], bss_begin[], bss_end[], stack_end[];
extern void (*constructors_begin[])(void);
extern void (*constructors_end[])(void);

int main(void);
void reset_handler(void);

static void unexpected(void)
{
    for (;;) {
    }
}

#define HANDLER(name)                                                                                                  \
    void name(void);                                                                                                   \
    void name(void) __attribute__((weak, alias("unexpected")))
HANDLER(HardFault_Handler);
HANDLER(TIMER1_Handler);
HANDLER(FREE_Handler);

/* The kernel's handlers, if there is a kernel. */
void __attribute__((weak)) vPortSVCHandler(void);
void __attribute__((weak)) xPortPendSVHandler(void);
void __attribute__((weak)) xPortSysTickHandler(void);

void SysTick_Handler(void);
void __attribute__((weak)) SysTick_Handler(void)
{
    if (xPortSysTickHandler != NULL) {
        xPortSysTickHandler();
    }
}

typedef union vector {
    void *stack;
    void (*handler)(void);
} vector_t;

extern const vector_t vectors[16 + MPS2_INTERRUPTS];
__attribute__((section(".vectors"), used)) const vector_t vectors[16 + MPS2_INTERRUPTS] = {
    [0] = {.stack = stack_end},
    [1] = {.handler = reset_handler},
    [2] = {.handler = unexpected},
    [3] = {.handler = HardFault_Handler},
    [4] = {.handler = unexpected},
    [5] = {.handler = unexpected},
    [6] = {.handler = unexpected},
    [11] = {.handler = vPortSVCHandler},
    [14] = {.handler = xPortPendSVHandler},
    [15] = {.handler = SysTick_Handler},
    [16 + TIMER1_IRQn] = {.handler = TIMER1_Handler},
    [16 + FREE_IRQn] = {.handler = FREE_Handler},
};

void reset_handler(void)
{
    SCB->CPACR |= 0xFU << 20U;
    __DSB();
    __ISB();
    memcpy(data_begin, data_image, (size_t)(data_end - data_begin));
    memset(bss_begin, 0, (size_t)(bss_end - bss_begin));
    epg_one_core_outputs_safe();
    for (void (**constructor)(void) = constructors_begin; constructor < constructors_end; constructor++) {
        (*constructor)();
    }
    (void)main();
    unexpected();
}
