/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that the files of the Pico's port layer call in each other, besides those of `epg/family.h`.
 */
#ifndef EPG_PICO_PARTS_H
#define EPG_PICO_PARTS_H

#include <stdatomic.h>

#include "epg/family.h"
#include "epg/pico.h"
#include "epg/pico_sdk.h"

/* port.c ------------------------------------------------------------------------------------------------------- */

/** PWM slices that drive outputs, one bit per slice.  They start together with the slice of the tick. */
extern uint32_t epg_pico_output_slices;

/** Set to true while peripherals are started, if other code uses one of them. */
extern bool epg_pico_resource_taken;

/* quadrature.c ------------------------------------------------------------------------------------------------- */

/** Stops all decoders and frees their state machines. */
void epg_pico_quadrature_stop_all(void);

/* clock.c ------------------------------------------------------------------------------------------------------ */

/** Microseconds since power-on.  The function is in RAM and takes a fixed time. */
uint64_t epg_pico_timer_us(void);

/**
 * Starts core 1's SysTick, which measures time within a cycle.  `clock` is clk_sys in Hz.  Must be called on core 1.
 */
void epg_pico_cycle_clock_start(uint32_t clock);

/** Converts clocks of clk_sys, fewer than 2^24, to nanoseconds. */
uint32_t epg_pico_clocks_to_ns(uint32_t clocks);

/**
 * Begin of a cycle, at `now_ns`: until epg_pico_cycle_clock_end(), epg_port_time_ns() on core 1 has the resolution of
 * clk_sys.  At other times it has the microseconds of the timer.
 */
void epg_pico_cycle_clock_begin(uint64_t now_ns);
/** End of a cycle. */
void epg_pico_cycle_clock_end(void);

/* core1.c ------------------------------------------------------------------------------------------------------ */

/** True if the program has started code on core 1 and has not reset the core since. */
bool epg_pico_core1_taken(void);

/* The SDK's functions.  A call by the usual name, without __real_, is redirected to core1.c. */
void __real_multicore_reset_core1(void);
void __real_multicore_launch_core1_with_stack(void (*entry)(void), uint32_t *bottom, size_t size);

/* control_core.c ----------------------------------------------------------------------------------------------- */

/** True if the control loop has core 1 now. */
bool epg_pico_control_runs(void);

/**
 * Makes core 1 wait in RAM until epg_pico_control_release(), so that it does not read flash.  Must be called on core 0.
 *
 * Returns false if the target is enabled, if core 1 does not answer within `timeout_us`, or if the program runs code on
 * core 1.
 */
bool epg_pico_control_hold(uint32_t timeout_us);
/** Ends the wait of core 1. */
void epg_pico_control_release(void);

/* safe_state.c ------------------------------------------------------------------------------------------------- */

/** Makes the pin of each output a plain output at its safe level.  Runs before main(), and when a target stops. */
void epg_pico_outputs_start(void);

/** Like epg_pico_safe_state(), but before an intended reset: no fault is reported after the reset. */
void epg_pico_outputs_off(void);

#endif
