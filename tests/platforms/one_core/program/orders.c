/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * UART 2 takes orders from the test, one letter each, and answers each of them by a line of numbers; qemu.py has their
 * names.
 *
 * | order | effect                                                                      |
 * |-------|-----------------------------------------------------------------------------|
 * | `?`   | none                                                                        |
 * | `s`   | stops the target                                                            |
 * | `r`   | starts it                                                                   |
 * | `b`   | masks interrupts by BASEPRI for 4 ms, as a critical section of a kernel     |
 * | `i`   | runs an interrupt of priority 1 for 4 ms                                    |
 * | `p`   | masks all interrupts by PRIMASK for 3.5 ms, as EPG and the kernel never do  |
 * | `o`   | makes the next five cycles 1.5 ms long                                      |
 * | `v`   | none; the result: only the vectors that EPG uses differ from the program's  |
 * | `e`   | enables an interrupt of priority 0 that never comes                         |
 * | `d`   | disables it                                                                 |
 * | `g`   | sets PRIGROUP so that no interrupt can interrupt another one                |
 * | `G`   | sets it back                                                                |
 * | `n`   | stops SysTick                                                               |
 * | `h`   | executes an undefined instruction                                           |
 * | `f`   | the same within a control cycle; the program's fault handler returns        |
 * | `m`   | the same, with a main stack pointer that points nowhere                     |
 */
#include "epg/family.h"
#include "epg/mps2.h"
#include "jiwy.h"
#include "program.h"

volatile uint32_t timer1_calls, systick_calls;

/* Survive a reset. */
static __attribute__((section(".noinit"))) volatile uint32_t driven_in_fault; /* motors in the HardFault handler */
static __attribute__((section(".noinit"))) volatile uint32_t faults;          /* calls of that handler */

static volatile bool fault_returned;

static volatile uint32_t cycles_before, cycles_after; /* of a time in which interrupts were masked or late */

static uint32_t cycles(void)
{
    epg_status_t status;
    return epg_control_status(jiwy_target.control, &status) ? status.statistics.cycles : 0U;
}

/** Waits for a fraction of milliseconds. */
static void spin(uint32_t milliseconds, uint32_t of)
{
    const uint64_t end = mps2_clock() + (uint64_t)milliseconds * 25000U / 16U / of;
    while (mps2_clock() < end) {
    }
}

static void __attribute__((noinline)) mask_all_interrupts(void)
{
    __disable_irq();
    spin(7, 2);
    __enable_irq();
}

/** EPG's vectors: faults, the tick, the clock, the UARTs of agent and console, and the service of bare metal. */
static bool vectors_are_the_programs(void)
{
    const uint32_t mine = 1U << TIMER0_IRQn | 1U << DUALTIMER_IRQn | 0xFU | 1U << SPARE0_IRQn;
    const uint32_t *table = (const uint32_t *)(uintptr_t)SCB->VTOR;
    const uint32_t *program = NULL; /* the program's table is at address 0 */
    __asm volatile("" : "+r"(program));
    for (uint32_t i = 0; i < 16U + MPS2_INTERRUPTS; i++) {
        const bool fault = i >= 3U && i <= 6U;
        const bool interrupt = i >= 16U && (mine >> (i - 16U) & 1U) != 0U;
        if (table[i] != program[i] && !fault && !interrupt) {
            return false;
        }
    }
    return table != program;
}

void TIMER1_Handler(void);
void FREE_Handler(void);
void HardFault_Handler(void);

void TIMER1_Handler(void)
{
    TIMER1->interrupt = 1U;
    timer1_calls++;
}

void FREE_Handler(void)
{
    cycles_before = jiwy_target.control->statistics.cycles;
    spin(4, 1);
    cycles_after = jiwy_target.control->statistics.cycles;
}

/** As fault handlers usually find the registers that the core has saved: by LR and the stack pointers. */
void __attribute__((naked)) HardFault_Handler(void)
{
    __asm__ volatile(".syntax unified\n"
                     "tst lr, #4\n"
                     "ite eq\n"
                     "mrseq r0, msp\n"
                     "mrsne r0, psp\n"
                     "b hard_fault\n");
}

void hard_fault(uint32_t *frame);

__attribute__((used)) void hard_fault(uint32_t *frame)
{
    driven_in_fault = axes_driven();
    faults++;
    if (*(const uint16_t *)(uintptr_t)frame[6] == AXES_UNDEFINED) {
        frame[6] += 2U; /* the program counter: behind that instruction */
        fault_returned = true;
        return;
    }
    for (;;) {
    }
}

static void put(char byte)
{
    while ((UART(2)->state & 1U) != 0U) {
    }
    UART(2)->data = (unsigned char)byte;
}

static void say(uint64_t number, char end)
{
    char text[21];
    unsigned int begin = sizeof text;
    text[--begin] = end;
    do {
        text[--begin] = (char)('0' + number % 10U);
        number /= 10U;
    } while (number > 0U);
    for (; begin < sizeof text; begin++) {
        put(text[begin]);
    }
}

static void answer(bool result)
{
    static epg_status_t status;
    uint64_t now;
    do { /* time and status of the same cycle */
        if (!epg_control_status(jiwy_target.control, &status)) {
            status = (epg_status_t){0};
        }
        now = mps2_clock();
    } while (cycles() != status.statistics.cycles);
    epg_mcu_status_t chip;
    epg_mcu_status(&chip);
    say(now * 16U / 25U, ' ');
    say(status.statistics.cycles, ' ');
    say(status.statistics.missed, ' ');
    say(status.statistics.overruns, ' ');
    say(status.enabled, ' ');
    say(status.fault, ' ');
    say(status.statistics.lateness_max, ' ');
    say(axes_driven(), ' ');
    say(sums, ' ');
    say(wrong_sums, ' ');
    say(timer1_calls, ' ');
    say(systick_calls, ' ');
    say(chip.error, ' ');
    say((uint64_t)(epg_mcu_wrong_priority()->interrupt + 16), ' ');
    say(chip.control_stack_used, ' ');
    say(chip.service_stack_used, ' ');
    say(cycles_after - cycles_before, ' ');
    say(faults, ' ');
    say(driven_in_fault, ' ');
    say(atomic_load(&jiwy_target.control->alive), ' ');
    say(result, '\n');
}

static void set_priority_group(uint32_t group)
{
    NVIC_SetPriorityGrouping(group);
}

static bool obey(char order)
{
    switch (order) {
    case 's':
        return jiwy_stop();
    case 'r':
        return jiwy_start();
    case 'b':
        cycles_before = cycles();
        hold_basepri(4);
        cycles_after = cycles();
        return true;
    case 'i':
        NVIC_SetPriority(FREE_IRQn, 1U);
        NVIC_EnableIRQ(FREE_IRQn);
        NVIC_SetPendingIRQ(FREE_IRQn);
        __DSB();
        __ISB();
        NVIC_DisableIRQ(FREE_IRQn);
        return true;
    case 'p':
        mask_all_interrupts();
        return true;
    case 'o':
        axes_long_cycles = 5U;
        return true;
    case 'v':
        return vectors_are_the_programs();
    case 'e':
        NVIC_SetPriority(FREE_IRQn, 0U);
        NVIC_EnableIRQ(FREE_IRQn);
        return true;
    case 'd':
        NVIC_DisableIRQ(FREE_IRQn);
        return true;
    case 'g':
        set_priority_group(7U);
        return true;
    case 'G':
        set_priority_group(0U);
        return true;
    case 'n':
        SysTick->CTRL = 0U;
        return true;
    case 'h':
        __asm volatile("udf #0");
        return true;
    case 'f':
        axes_fault = true;
        return true;
    case 'm':
        __asm volatile("movw r0, #0xFF00\n movt r0, #0x2FFF\n msr msp, r0\n udf #0" ::: "r0");
        return true;
    default:
        return true;
    }
}

void orders_start(void)
{
    UART(2)->divider = 16U;
    UART(2)->ctrl = 3U;
    (void)UART(2)->data;                             /* QEMU asks its other end for bytes from this read on */
    TIMER1->reload = MPS2_HZ / 1000U * 5U / 2U - 1U; /* 2.5 ms */
    TIMER1->ctrl = 9U;
    NVIC_SetPriority(TIMER1_IRQn, 3U);
    NVIC_EnableIRQ(TIMER1_IRQn);
}

void orders_obey(void)
{
    if (fault_returned) {
        driven_in_fault |= axes_driven();
    }
    if ((UART(2)->state & 2U) != 0U) {
        const char order = (char)UART(2)->data;
        answer(obey(order));
    }
}
