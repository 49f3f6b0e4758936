/* SPDX-License-Identifier: Apache-2.0 */
/** @file The start of a small program: a table of vectors that the program may change, variables, FPU, main(). */
#include "small.h"

#include <string.h>

extern unsigned char data_begin[], data_end[], data_image[], bss_begin[], bss_end[], stack_end[];

void reset_handler(void);
volatile uint32_t unexpected_exception;

static void unexpected(void)
{
    unexpected_exception = __get_IPSR();
    for (;;) {
    }
}

typedef union vector {
    void *stack;
    void (*handler)(void);
} vector_t;

__attribute__((section(".vectors"), used)) static const vector_t first_vectors[16] = {
    [0] = {.stack = stack_end},
    [1] = {.handler = reset_handler},
    [2 ... 15] = {.handler = unexpected},
};

__attribute__((aligned(1024))) static vector_t vectors[16 + 150];

void set_handler(int interrupt, void (*handler)(void))
{
    vectors[16 + interrupt].handler = handler;
}

void reset_handler(void)
{
    SCB->CPACR |= 0xFU << 20;
    __DSB();
    __ISB();
    memcpy(data_begin, data_image, (size_t)(data_end - data_begin));
    memset(bss_begin, 0, (size_t)(bss_end - bss_begin));
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        vectors[i].handler = unexpected;
    SCB->VTOR = (uint32_t)vectors;
    (void)main();
    for (;;)
        __WFI();
}
