/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The program without an operating system: its main loop obeys the test and computes.
 */
#include "epg/family.h"
#include "jiwy.h"
#include "program.h"

#define SERVICE_PRIORITY 15U

void SysTick_Handler(void);

void SysTick_Handler(void)
{
    systick_calls++;
}

static void spin(uint32_t milliseconds)
{
    const uint64_t end = mps2_clock() + (uint64_t)milliseconds * 25000U / 16U;
    while (mps2_clock() < end) {
    }
}

/** The interrupts of main() and of a kernel cannot be told apart here: BASEPRI is a register of the core. */
void hold_basepri(uint32_t milliseconds)
{
    __set_BASEPRI(1U << (8U - __NVIC_PRIO_BITS));
    spin(milliseconds);
    __set_BASEPRI(0U);
}

int main(void)
{
    orders_start();
    sums_compute();
    SysTick->LOAD = MPS2_HZ / 1000U - 1U;
    SysTick->VAL = 0U;
    NVIC_SetPriority(SysTick_IRQn, SERVICE_PRIORITY);
    SysTick->CTRL = SysTick_CTRL_CLKSOURCE_Msk | SysTick_CTRL_TICKINT_Msk | SysTick_CTRL_ENABLE_Msk;
    (void)jiwy_start();
    for (;;) {
        orders_obey();
        sums_compute();
    }
}
