/* SPDX-License-Identifier: Apache-2.0 */
/** @file Interrupts that software makes pending: nesting by priority, masks, and a log of what happened. */
#include "small.h"

enum { LOW = 140, MIDDLE = 141, HIGH = 142 };

volatile char events[64];
volatile uint32_t length, ended;

static void add(char event)
{
    events[length] = event;
    length = length + 1U;
}

static void on_high(void)
{
    add('H');
    add('h');
}

static void on_middle(void)
{
    add('M');
    NVIC_SetPendingIRQ((IRQn_Type)HIGH);
    NVIC_SetPendingIRQ((IRQn_Type)LOW);
    add('m');
}

static void on_low(void)
{
    add('L');
    add('l');
}

static void use(int interrupt, uint32_t priority, void (*handler)(void))
{
    set_handler(interrupt, handler);
    NVIC_SetPriority((IRQn_Type)interrupt, priority);
    NVIC_EnableIRQ((IRQn_Type)interrupt);
}

static void on_service_call(void)
{
    add('S');
}

int main(void)
{
    NVIC_SetPriorityGrouping(3);
    use(LOW, 8, on_low);
    use(MIDDLE, 4, on_middle);
    use(HIGH, 0, on_high);
    set_handler(SVCall_IRQn, on_service_call);

    NVIC_SetPendingIRQ((IRQn_Type)MIDDLE); /* HIGH preempts it; LOW waits for its end */
    add('1');
    __set_BASEPRI(4U << 4);
    NVIC_SetPendingIRQ((IRQn_Type)LOW);
    NVIC_SetPendingIRQ((IRQn_Type)MIDDLE);
    add('2');
    NVIC_SetPendingIRQ((IRQn_Type)HIGH);
    add('3');
    __set_BASEPRI(0);
    add('4');
    __disable_irq();
    NVIC_SetPendingIRQ((IRQn_Type)HIGH);
    add('5');
    __enable_irq();
    add('6');
    __ASM volatile("svc #0" ::: "memory");
    add('7');
    ended = 1;
    for (;;)
        __WFI();
}
