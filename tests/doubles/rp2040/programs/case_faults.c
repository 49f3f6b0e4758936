/* Faults; arguments[0] selects the kind. */
#include "cases.h"
#include "hardware/structs/mpu.h"
#include "pico/multicore.h"
#include "pico/stdlib.h"

volatile uint32_t fault_seen;

static void cause(void)
{
    switch (arguments[0]) {
    case 0:
        __asm volatile("str %0, [%1]" : : "l"(1u), "l"(0x20000001u) : "memory"); /* unaligned */
        break;
    case 1:
        *(volatile uint32_t *)(uintptr_t)0x60000000u = 1; /* no device at this address */
        break;
    case 2:
        __asm volatile("udf #0");
        break;
    case 3:
        __breakpoint();
        break;
    case 4:
        ((void (*)(void))(uintptr_t)0x40000001u)(); /* not executable */
        break;
    case 5:
        /* address without the Thumb bit */
        __asm volatile("mov r0, %0\n\tbx r0" : : "r"((uintptr_t)&cause & ~(uintptr_t)1u) : "r0");
        break;
    case 7: { /* a stack that grows into its guard */
        mpu_hw->rbar = (0x20030000u & ~0xffu) | M0PLUS_MPU_RBAR_VALID_BITS;
        /* 256 bytes, in which only the third subregion of 32 bytes is enabled */
        mpu_hw->rasr = 1u | (7u << 1) | (0xfbu << 8) | 0x10000000u;
        mpu_hw->ctrl = 5;
        *(volatile uint32_t *)(uintptr_t)0x2003003cu = 1;
        *(volatile uint32_t *)(uintptr_t)0x20030060u = 2;
        *(volatile uint32_t *)(uintptr_t)0x2003005cu = 3;
        break;
    }
    case 6:
        __asm volatile("cpsid i\n\tsvc #0"); /* cannot be taken while PRIMASK is set */
        break;
    default:
        break;
    }
}

/* The handler records the stacked PC and the cause.  If arguments[1] is set, it causes another fault. */
void __attribute__((used)) note_fault(const uint32_t *frame)
{
    fault_seen++;
    results[0] = frame[6];
    results[1] = get_core_num();
    if (arguments[1] != 0) {
        __asm volatile("udf #1");
    }
    for (;;) {
        __asm volatile("wfi");
    }
}

void __attribute__((naked)) isr_hardfault(void)
{
    __asm volatile("mov r0, sp\n\tldr r1, =note_fault\n\tbx r1");
}

void case_fault(void)
{
    cause();
}

void case_fault_of_core_1(void)
{
    multicore_reset_core1();
    multicore_launch_core1(cause);
    busy_wait_us(100);
}
