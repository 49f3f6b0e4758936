/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the parts of the port layer ask of each other.
 */
#ifndef EPG_PICO_PARTS_H
#define EPG_PICO_PARTS_H

#include <stdatomic.h>

#include "epg/pico.h"
#include "epg_pico_target.h"
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

/** `fault`: what ended the run before this one; it is latched. */
epg_pico_error_t epg_pico_control_start(const epg_pico_target_t *pico, epg_fault_t fault);
void epg_pico_control_stop(void);

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

/** What the previous run left behind: EPG_FAULT_NONE, EPG_FAULT_WATCHDOG or EPG_FAULT_PROCESSOR.  Once per reset. */
epg_fault_t epg_pico_fault_before_reset(void);

/** Puts a handler before the HardFault handler of this core's vector table, once per table. */
void epg_pico_guard_faults(void);

/* stack.c ------------------------------------------------------------------------------------------------------ */

typedef struct epg_pico_stack {
    uint32_t *bottom;
    uint32_t *top;
} epg_pico_stack_t;

/** Fills the words from `bottom` to `end` with a pattern. */
void epg_pico_stack_paint(uint32_t *bottom, const uint32_t *end);

/** Bytes that have ever been used of `stack`, whose first `unpainted` bytes are not looked at. */
uint32_t epg_pico_stack_used(const epg_pico_stack_t *stack, uint32_t unpainted);

/** Whether all of a painted stack has been used, and perhaps more. */
bool epg_pico_stack_full(const epg_pico_stack_t *stack);

extern const epg_pico_stack_t epg_pico_main_stack;
extern const epg_pico_stack_t epg_pico_control_stack;

/* start.c ------------------------------------------------------------------------------------------------------- */

/** Keeps `problem` as the error that epg_pico_status() tells. */
void epg_pico_report(epg_pico_error_t problem);

/**
 * What `serve` does besides its middleware, which is waiting within it: sends what that has written, calls `rest`, which
 * returns soon, and serves transports and console.
 */
void epg_pico_serve_others(void (*rest)(void));

/* service.c of bare_metal and freertos -------------------------------------------------------------------------- */

/** Bytes by which the frame of an exception is larger where it has the registers of an FPU (Armv8-M, B3.19). */
#if PICO_RP2040
#define EPG_PICO_FPU_FRAME 0
#else
#define EPG_PICO_FPU_FRAME 72
#endif

/** Calls `serve` on core 0 at least once per millisecond. */
bool epg_pico_service_start(void (*serve)(void));

/** `serve` is not running, nor called again, when this has returned true.  False when the caller cannot wait for it. */
bool epg_pico_service_stop(void);

/** Asks for `serve` at once; from any interrupt of core 0. */
void epg_pico_service_wake(void);

/** Fills in the stack on which `serve` runs. */
void epg_pico_service_stack(uint32_t *size, uint32_t *used);

#endif
