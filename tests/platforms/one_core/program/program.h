/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The parts of the program.
 */
#ifndef PROGRAM_H
#define PROGRAM_H

#include <stdbool.h>
#include <stdint.h>

/* axes.c */
/** Number of motors that are driven, 0 to 2. */
uint32_t axes_driven(void);
/** Number of cycles that are to last 1.5 ms. */
extern volatile uint32_t axes_long_cycles;
/** The cycle that takes the next request to enable executes this undefined instruction. */
extern volatile bool axes_fault;
#define AXES_UNDEFINED 0xDE01U /* udf #1 */

/* orders.c */
/** Starts the line of the test, UART 2. */
void orders_start(void);
/** Obeys the orders that have come. */
void orders_obey(void);
/** How often TIMER1's handler and SysTick's handler ran, which are in the program's table of vectors. */
extern volatile uint32_t timer1_calls, systick_calls;

/* program.c */
/** Computes sums of floating-point numbers, and counts those that differ from the first. */
void sums_compute(void);
extern volatile uint32_t sums, wrong_sums;

/* bare_metal.c, freertos.c */
/** Masks all interrupts that can be masked by BASEPRI for `milliseconds`. */
void hold_basepri(uint32_t milliseconds);

#endif
