/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The device header: interrupts and registers, with Arm's header of the core.
 *
 * Peripherals: Cortex-M System Design Kit, technical reference manual, DDI0479 (APB timer, APB dual timer, APB UART, APB
 * watchdog: tables of the programmers model).  Addresses and interrupts: application notes AN386 and AN500.
 */
#ifndef MPS2_DEVICE_H
#define MPS2_DEVICE_H

#pragma GCC system_header

#include <stdint.h>

typedef enum IRQn {
    NonMaskableInt_IRQn = -14,
    HardFault_IRQn = -13,
    MemoryManagement_IRQn = -12,
    BusFault_IRQn = -11,
    UsageFault_IRQn = -10,
    SVCall_IRQn = -5,
    DebugMonitor_IRQn = -4,
    PendSV_IRQn = -2,
    SysTick_IRQn = -1,
    UART0_RX_IRQn = 0,
    UART0_TX_IRQn = 1,
    UART1_RX_IRQn = 2,
    UART1_TX_IRQn = 3,
    UART2_RX_IRQn = 4,
    TIMER0_IRQn = 8,
    TIMER1_IRQn = 9,
    DUALTIMER_IRQn = 10,
    FREE_IRQn = 28,
    SPARE0_IRQn = 30,
    SPARE1_IRQn = 31
} IRQn_Type;

#define MPS2_INTERRUPTS 32

/** All peripherals and the core have this clock. */
#define MPS2_HZ 25000000U

/** The bits that this program uses, as on the STM32H743; QEMU has eight. */
#define __NVIC_PRIO_BITS 4
#define __MPU_PRESENT 1
#define __VTOR_PRESENT 1
#define __Vendor_SysTickConfig 0
#if __ARM_FP & 8 /* doubles */
#define __CM7_REV 0x0001
#define __FPU_PRESENT 1
#define __ICACHE_PRESENT 1
#define __DCACHE_PRESENT 1
#include "core_cm7.h"
#elif defined(__ARM_FP)
#define __CM4_REV 0x0001
#define __FPU_PRESENT 1
#include "core_cm4.h"
#else
#define __CM3_REV 0x0201
#include "core_cm3.h"
#endif

/** A timer counts down to 0, and continues with `reload`. */
typedef struct mps2_timer {
    volatile uint32_t ctrl; /* bit 0: on; bit 3: interrupt on */
    volatile uint32_t value;
    volatile uint32_t reload;
    volatile uint32_t interrupt; /* bit 0: requested; writing 1 clears it */
} mps2_timer_t;

typedef struct mps2_dual_timer {
    volatile uint32_t load;
    volatile uint32_t value;
    volatile uint32_t control; /* bit 7: on; bit 5: interrupt on; bits 3-2: 1 divides by 16; bit 1: 32 bits */
    volatile uint32_t clear;
    volatile uint32_t raw; /* bit 0: requested */
} mps2_dual_timer_t;

typedef struct mps2_uart {
    volatile uint32_t data;
    volatile uint32_t state;     /* bit 0: transmit buffer full; bit 1: receive buffer full */
    volatile uint32_t ctrl;      /* bits 0, 1: transmit and receive on; bits 2, 3: their interrupts on */
    volatile uint32_t interrupt; /* bits 0, 1: transmit and receive requested; writing 1 clears them */
    volatile uint32_t divider;
} mps2_uart_t;

/** Counts down twice: the first time raises the NMI, the second resets the board. */
typedef struct mps2_watchdog {
    volatile uint32_t load;
    volatile uint32_t value;
    volatile uint32_t control; /* bit 0: on; bit 1: reset on */
    volatile uint32_t clear;
} mps2_watchdog_t;

#define TIMER0 ((mps2_timer_t *)0x40000000U)
#define TIMER1 ((mps2_timer_t *)0x40001000U)
#define DUALTIMER ((mps2_dual_timer_t *)0x40002000U)
#define UART(number) ((mps2_uart_t *)(0x40004000U + 0x1000U * (number)))
#define WATCHDOG ((mps2_watchdog_t *)0x40008000U)
#define WATCHDOG_LOCK (*(volatile uint32_t *)0x40008C00U)

#endif
