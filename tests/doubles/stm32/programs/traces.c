/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Random interrupts, the same on the emulated STM32H743 and on QEMU's MPS2 board with a Cortex-M7 (MPS2 is defined).
 *
 * Software makes interrupts pending, masks them, and changes priorities, in the thread and in their handlers.  A log has
 * the order of entries and exits, registers at these places, and sums of the registers of the FPU over interrupts.
 * Only the upper four bits of priorities are used, which both processors have.
 */
#include "small.h"

enum { FIRST = 3, COUNT = 12, SEEDS = 120, ACTIONS = 60, DEPTH = 8, LIMIT = 120000 };

#ifndef MPS2
__attribute__((section(".axi")))
#endif
volatile uint32_t trace[LIMIT];
volatile uint32_t length, wrong_registers, ended;
static uint32_t random_state, budget, depth;

extern unsigned char stack_end[];

static uint32_t random_word(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state;
}

static uint32_t below(uint32_t limit)
{
    return (random_word() >> 8) % limit;
}

static void note(uint32_t word)
{
    if (length < LIMIT) {
        trace[length] = word;
        length = length + 1U;
    }
}

static void wait(void)
{
    __DSB();
    __ISB();
}

static uint32_t some_interrupts(void)
{
    return random_word() & random_word() & ((1U << COUNT) - 1U) << FIRST;
}

static IRQn_Type one_interrupt(void)
{
    return (IRQn_Type)(FIRST + below(COUNT));
}

/** Makes interrupts pending while all registers of the FPU have known contents.  Not inlined: handlers do not save them. */
__attribute__((noinline)) static void interrupt_floats(uint32_t interrupts)
{
    uint32_t before[32], after[32];
    note(__get_FPSCR());                                /* of the thread, of an earlier call, or of a new context */
    uint32_t status = below(4) << 22 | below(16) << 28; /* rounding, flags of comparisons */
    for (uint32_t i = 0; i < 32; i++) {
        before[i] = random_word();
    }
    __ASM volatile("vmsr fpscr, %[status]\n"
                   "vldm %[before], {s0-s31}\n"
                   "str %[interrupts], [%[pend]]\n"
                   "dsb\n"
                   "isb\n"
                   "vstm %[after], {s0-s31}\n"
                   "vmrs %[status], fpscr\n"
                   : [status] "+&r"(status)
                   : [before] "r"(before), [after] "r"(after), [interrupts] "r"(interrupts), [pend] "r"(&NVIC->ISPR[0])
                   : "memory", "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10", "s11", "s12", "s13",
                     "s14", "s15", "s16", "s17", "s18", "s19", "s20", "s21", "s22", "s23", "s24", "s25", "s26", "s27",
                     "s28", "s29", "s30", "s31");
    uint32_t sum = 0;
    for (uint32_t i = 0; i < 32; i++) {
        wrong_registers = wrong_registers + (before[i] != after[i]);
        sum = sum * 31U + after[i];
    }
    note(status);
    note(sum);
}

static void note_state(uint32_t kind)
{
    uint32_t control, stack;
    __ASM volatile("mrs %0, control\n mov %1, sp" : "=r"(control), "=r"(stack));
    note(kind << 24 | __get_IPSR() << 12 | __get_BASEPRI() << 4 | __get_PRIMASK() << 3 | __get_FAULTMASK() << 2);
    note(control << 24 | ((uint32_t)stack_end - stack));
    /* VECTACTIVE, RETTOBASE, ISRPENDING, PENDSTSET, PENDSVSET */
    note(SCB->ICSR & (SCB_ICSR_VECTACTIVE_Msk | SCB_ICSR_RETTOBASE_Msk | SCB_ICSR_ISRPENDING_Msk |
                      SCB_ICSR_PENDSTSET_Msk | SCB_ICSR_PENDSVSET_Msk));
    note(NVIC->ISPR[0]);
    note(NVIC->IABR[0]);
}

static void act(void)
{
    if (budget == 0U) {
        return;
    }
    budget--;
    const uint32_t action = below(16);
    if (action < 4U) {
        NVIC_SetPendingIRQ(one_interrupt());
    } else if (action < 6U) {
        NVIC->ISPR[0] = some_interrupts();
    } else if (action < 8U) {
        interrupt_floats(some_interrupts());
    } else if (action == 8U) {
        __set_BASEPRI(below(16) << 4);
    } else if (action == 9U) {
        __set_BASEPRI_MAX(below(16) << 4);
    } else if (action == 10U) {
        if (below(2) == 0U) {
            __disable_irq();
        } else {
            __enable_irq();
        }
    } else if (action == 11U) {
        if (below(4) == 0U) {
            __disable_fault_irq(); /* until the next return */
        } else {
            __enable_fault_irq();
            __enable_irq();
            __set_BASEPRI(0);
        }
    } else if (action == 12U) {
        NVIC_SetPriority(one_interrupt(), below(16));
    } else if (action == 13U) {
        SCB->ICSR = below(2) == 0U ? SCB_ICSR_PENDSVSET_Msk : SCB_ICSR_PENDSTSET_Msk;
    } else if (action == 14U) {
        if (below(2) == 0U) {
            NVIC_DisableIRQ(one_interrupt());
        } else {
            NVIC->ISER[0] = ((1U << COUNT) - 1U) << FIRST;
        }
    } else {
        NVIC_ClearPendingIRQ(one_interrupt());
    }
    wait();
    note_state(0x10U + action);
}

static void on_interrupt(void)
{
    note(0xE0000000U | ((uint32_t)__builtin_return_address(0) & 0xFFU));
    note_state(1);
    depth++;
    for (uint32_t count = depth < DEPTH ? below(4) : 0U; count > 0U; count--) {
        act();
    }
    depth--;
    note_state(2);
}

static void run(uint32_t seed)
{
    random_state = seed * 2654435761U + 1U;
    budget = ACTIONS;
    NVIC_SetPriorityGrouping(3U + below(4));
    for (uint32_t i = 0; i < COUNT; i++) {
        NVIC_SetPriority((IRQn_Type)(FIRST + i), below(16));
    }
    NVIC_SetPriority(PendSV_IRQn, below(16));
    NVIC_SetPriority(SysTick_IRQn, below(16));
    NVIC->ISER[0] = ((1U << COUNT) - 1U) << FIRST;
    while (budget > 0U) {
        act();
    }
    NVIC->ISER[0] = ((1U << COUNT) - 1U) << FIRST;
    __set_BASEPRI(0);
    __enable_fault_irq();
    __enable_irq();
    wait();
    note_state(3);
}

/** Sends the length of the log and its words by the first UART of the MPS2 board.  Not inlined: main() has the same stack on both boards. */
__attribute__((noinline)) static void send(void)
{
    __ASM volatile("");
#ifdef MPS2
    volatile uint32_t *const uart = (volatile uint32_t *)0x40004000U; /* CMSDK: data, state, control, -, divider */
    uart[4] = 16;
    uart[2] = 1;
    for (uint32_t i = 0; i <= length; i++) {
        const uint32_t word = i == 0U ? length : trace[i - 1U];
        for (uint32_t byte = 0; byte < 4U; byte++) {
            while ((uart[1] & 1U) != 0U) {
            }
            uart[0] = word >> 8U * byte & 0xFFU;
        }
    }
#endif
}

int main(void)
{
    for (uint32_t i = 0; i < COUNT; i++) {
        set_handler((int)(FIRST + i), on_interrupt);
    }
    set_handler(PendSV_IRQn, on_interrupt);
    set_handler(SysTick_IRQn, on_interrupt);
    for (uint32_t seed = 1; seed <= SEEDS; seed++) {
        run(seed);
    }
    ended = 1;
    send();
    for (;;)
        __WFI();
}
