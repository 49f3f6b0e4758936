/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the parts of the Pico's port layer ask of each other, besides what `epg/family.h` says.
 */
#ifndef EPG_PICO_PARTS_H
#define EPG_PICO_PARTS_H

#include <stdatomic.h>

#include "epg/family.h"
#include "epg/pico.h"
#include "sdk.h"

/* port.c ------------------------------------------------------------------------------------------------------- */

/** PWM slices that drive outputs; they are started together with the tick's. */
extern uint32_t epg_pico_output_slices;

/** A peripheral that was taken by somebody else: set while peripherals are started. */
extern bool epg_pico_resource_taken;

/* quadrature.c ------------------------------------------------------------------------------------------------- */

/** Gives back all state machines. */
void epg_pico_quadrature_stop_all(void);

/* clock.c ------------------------------------------------------------------------------------------------------ */

/** Microseconds since power-on, in RAM and without a loop. */
uint64_t epg_pico_timer_us(void);

/** Prepares the fine clock of a cycle; on core 1.  `clock` is clk_sys in Hz. */
void epg_pico_cycle_clock_start(uint32_t clock);

/** Clocks of clk_sys, fewer than 2^24, in nanoseconds. */
uint32_t epg_pico_clocks_to_ns(uint32_t clocks);

/** From here on, epg_port_time_ns() on core 1 counts from `now_ns` in clocks of clk_sys. */
void epg_pico_cycle_clock_begin(uint64_t now_ns);
void epg_pico_cycle_clock_end(void);

/* core1.c ------------------------------------------------------------------------------------------------------ */

/** Whether the program has started something of its own on core 1 and has not reset the core since. */
bool epg_pico_core1_taken(void);

/* The SDK's own functions; by their usual names core1.c is called. */
void __real_multicore_reset_core1(void);
void __real_multicore_launch_core1_with_stack(void (*entry)(void), uint32_t *bottom, size_t size);

/* control_core.c ----------------------------------------------------------------------------------------------- */

/** Whether core 1 is the control loop's now. */
bool epg_pico_control_runs(void);

/**
 * Keeps core 1 out of flash until epg_pico_control_release().  False when the target is enabled, when core 1 does not
 * answer within `timeout_us`, or when the program runs something of its own on core 1.
 */
bool epg_pico_control_hold(uint32_t timeout_us);
void epg_pico_control_release(void);

/* safe_state.c ------------------------------------------------------------------------------------------------- */

/** Makes all outputs plain ones at their safe levels, as before main(). */
void epg_pico_outputs_start(void);

/** As epg_pico_safe_state(), before a reset that is wanted: no fault is reported after it. */
void epg_pico_outputs_off(void);

#endif
