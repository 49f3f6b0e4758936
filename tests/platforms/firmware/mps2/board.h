/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The registers that the programs use of Arm's MPS2 board, and of its processor.
 *
 * Peripherals: Cortex-M System Design Kit, technical reference manual, DDI0479 ("APB timer" and "APB UART", tables of
 * the programmers model).  Addresses and interrupts: application notes AN385, AN386 and AN500, memory map and table of
 * interrupts.  Processor: ARMv7-M architecture reference manual, DDI0403, B3.2 and B3.4.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

/** All peripherals have this clock. */
#define BOARD_HZ 25000000U

/** A timer of 32 bits counts down to 0, continues with `reload`, and requests its interrupt. */
typedef struct board_timer {
    volatile uint32_t ctrl; /**< bit 0: on; bit 3: interrupt on */
    volatile uint32_t value;
    volatile uint32_t reload;
    volatile uint32_t interrupt; /**< bit 0: requested; writing 1 clears it */
} board_timer_t;

#define TIMER_ON 1U
#define TIMER_INTERRUPT 8U

typedef struct board_uart {
    volatile uint32_t data;
    volatile uint32_t state;     /**< bit 0: transmit buffer full; bit 1: receive buffer full */
    volatile uint32_t ctrl;      /**< bit 0: transmit on; bit 1: receive on; bit 3: receive interrupt on */
    volatile uint32_t interrupt; /**< bit 1: receive interrupt requested; writing 1 clears it */
    volatile uint32_t divider;   /**< clocks per bit, at least 16 */
} board_uart_t;

#define UART_TRANSMIT_FULL 1U
#define UART_RECEIVE_FULL 2U
#define UART_TRANSMIT_ON 1U
#define UART_RECEIVE_ON 2U
#define UART_RECEIVE_INTERRUPT_ON 8U
#define UART_RECEIVE_INTERRUPT 2U

#define TIMER0 ((board_timer_t *)0x40000000U)
#define TIMER1 ((board_timer_t *)0x40001000U)
#define UART(number) ((board_uart_t *)(0x40004000U + 0x1000U * (number)))
#define UARTS 3U

/** Numbers of interrupts.  The receive interrupt of UART n has the number 2 n. */
enum { IRQ_UART0 = 0, IRQ_UART1 = 2, IRQ_UART2 = 4, IRQ_TIMER0 = 8, IRQ_TIMER1 = 9, IRQS = 32 };

/** Priorities; a smaller number is more urgent.  FreeRTOS masks those from 0x50 on in its critical sections. */
enum { PRIORITY_CYCLE = 0x20, PRIORITY_CLOCK = 0x40, PRIORITY_UART = 0x80 };

#define NVIC_ENABLE (*(volatile uint32_t *)0xE000E100U)
#define NVIC_PRIORITY ((volatile uint8_t *)0xE000E400U)
#define CPACR (*(volatile uint32_t *)0xE000ED88U) /* access to the floating-point unit */

static inline void board_interrupt_on(unsigned int number, uint8_t priority)
{
    NVIC_PRIORITY[number] = priority;
    NVIC_ENABLE = 1U << number;
}

#endif
