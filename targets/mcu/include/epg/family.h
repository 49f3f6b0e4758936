/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The interface between a family of chips and the platforms bare_metal and freertos.
 *
 * The platforms bring everything that does not depend on registers: they start and stop a target, run its communication
 * side, measure the use of the stacks, and manage the records of the store.
 *
 * A family brings everything that depends on registers: the tick and its interrupt, in which the control cycle runs;
 * pins and peripherals (`epg/port.h`); safe outputs; the watchdog; flash (`epg/sectors.h`); transports.
 *
 * The family also chooses where the two sides run.  On RP2040 and RP2350 the control side has core 1 to itself, and
 * the communication side runs on core 0.  On a chip with one core, the control side is the interrupt of the highest
 * priority, and the communication side runs at a lower priority.  The platforms work with both, because the
 * communication side never waits for the control side.
 *
 * Types and constants that the compiler needs are in a header of the family, `epg/family_port.h`:
 *
 * - `epg_family_target_t`: the type of a generated target.  It has at least the members `target`, `transport`,
 *   `transport_title` and `console_transport`, as in `epg/pico.h`
 * - `EPG_FAMILY_MIDDLEWARE_STACK`: bytes of stack that the middleware and the console need; generated
 * - `EPG_FAMILY_SERVICE_STACK_SIZE`: bytes of the communication side's stack on bare metal, if the user has set them;
 *   else undefined
 * - `EPG_FAMILY_FPU_FRAME`: bytes that the registers of an FPU add to the stack frame of an exception; 0 without FPU
 * - `EPG_FAMILY_SERVICE_TIMEOUT_MS`: milliseconds without a turn of the communication side after which the watchdog
 *   is no longer fed
 * - `epg_family_panic(format, ...)`: makes the outputs safe, reports the reason if it can (NULL: no reason), and
 *   never returns
 * - `epg_family_sleep()`: sleeps until the next interrupt
 * - `epg_family_in_interrupt()`: true if the caller is an interrupt or an exception
 * - `epg_family_time_us()`: low 32 bits of the microseconds since power-on; they wrap every 71 minutes, and never stop
 *
 * The last four may be functions or macros.
 */
#ifndef EPG_FAMILY_H
#define EPG_FAMILY_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/family_port.h"
#include "epg/fault.h"
#include "epg/mcu.h"
#include "epg/sectors.h"

/** A stack: the words from `bottom` up to, but not including, `top`.  It is filled from the top downwards. */
typedef struct epg_mcu_stack {
    uint32_t *bottom;
    uint32_t *top;
} epg_mcu_stack_t;

/* Brought by a family: control ---------------------------------------------------------------------------------- */

/**
 * Called first at each start, before anything has been started.  Returns EPG_MCU_OK if a start is possible now, else
 * the reason why not.  A family must check its clocks here, by epg_mcu_check_clock(), and can check priorities.
 */
epg_mcu_error_t epg_family_check_start(const epg_family_target_t *target);

/**
 * Starts the control loop.  Returns EPG_MCU_OK when the loop waits for its first tick, or the error that stopped it.
 *
 * It calls epg_control_start(), latches `fault` (the fault that ended the run before the last reset; EPG_FAULT_NONE if
 * there was none) and starts the watchdog.
 *
 * From then on the interrupt of a periodic timer calls epg_control_cycle() once per control period, with the time at
 * which the tick was due and the number of missed ticks (`epg/ticks.h`).  The implementation must keep three rules:
 *
 * - The timer repeats by itself.  No code re-arms it, so a tick can be late but is never lost.
 * - No interrupt that a user installs can delay the timer's interrupt, and that interrupt calls no function of a
 *   kernel.
 * - The interrupt feeds the watchdog only while the communication side is alive, that is, while epg_control_silence()
 *   is less than EPG_FAMILY_SERVICE_TIMEOUT_MS in control cycles.
 */
epg_mcu_error_t epg_family_control_start(const epg_family_target_t *target, epg_fault_t fault);

/**
 * Called once per second by the communication side while a target runs.  The family checks what the user's program can
 * have changed since the start, and latches a fault in the next cycle if the target must not go on.
 */
void epg_family_check_running(void);

/**
 * Stops the control loop.  When this returns, the outputs are safe, the peripherals are free again, and the watchdog is
 * off.  Does nothing if the loop is not running.
 */
void epg_family_control_stop(void);

/* Brought by a family: safety ----------------------------------------------------------------------------------- */

/** The fault that caused the last reset: EPG_FAULT_NONE, EPG_FAULT_WATCHDOG or EPG_FAULT_PROCESSOR. */
epg_fault_t epg_family_fault_before_reset(void);

/**
 * Installs a HardFault handler that makes the outputs safe and then calls the user's HardFault handler.  It may be
 * called more than once.
 */
void epg_family_guard_faults(void);

/** The stack of main() and of interrupts. */
extern const epg_mcu_stack_t epg_family_main_stack;
/** The stack on which the control cycle runs.  It is the main stack if the control cycle does not have its own. */
extern const epg_mcu_stack_t epg_family_control_stack;

/* Brought by a family: communication on bare metal ---------------------------------------------------------------- */

/*
 * On bare metal the communication side runs in an interrupt that no peripheral raises: software makes it pending.  It
 * has the lowest priority, so every other interrupt can interrupt it, and main() belongs to the user.
 */

/**
 * Claims two things on the core of the communication side: an interrupt of the lowest priority, whose entry in the
 * vector table becomes `handler`, and a timer whose interrupt calls epg_mcu_service_wake() every `period_us`
 * microseconds.
 *
 * Returns false if no interrupt or no timer is free.
 */
bool epg_family_service_claim(void (*handler)(void), uint32_t period_us);

/** Frees the interrupt and the timer that epg_family_service_claim() has claimed. */
void epg_family_service_release(void);

/** Makes the claimed interrupt pending.  May be called from every interrupt. */
void epg_family_service_pend(void);

/* Functions that a family can call -------------------------------------------------------------------------------- */

/**
 * The implementation of the functions that a family offers to programs, such as epg_pico_start().  They must be called
 * on the core on which the communication side runs.
 */
bool epg_mcu_start(const epg_family_target_t *target); /**< false: epg_mcu_status() reports the error */
bool epg_mcu_stop(void);                               /**< false: the caller cannot wait, and the target goes on */
void epg_mcu_status(epg_mcu_status_t *status);         /**< reads all stacks; not for interrupts */

/** Stores `problem` as the error that epg_mcu_status() reports. */
void epg_mcu_report(epg_mcu_error_t problem);

/**
 * The reason why a transport does not start, for epg_mcu_status().  Called by the `start` of a transport that then
 * returns false.  Without a call the reason is EPG_MCU_ERROR_RESOURCE.
 */
void epg_mcu_refuse(epg_mcu_error_t reason);

/**
 * Compares the frequency of a clock, in Hz, with that for which the generator computed the dividers.  Returns true if
 * they are equal; otherwise epg_mcu_wrong_clock() has both, with `name`, which must be a constant.  For
 * epg_family_check_start(), which then returns EPG_MCU_ERROR_CLOCK.
 */
bool epg_mcu_check_clock(const char *name, uint32_t expected_hz, uint32_t found_hz);

/** The clock that was the reason for EPG_MCU_ERROR_CLOCK.  It is not a part of the status, so that small stacks can hold a status. */
const epg_mcu_clock_t *epg_mcu_wrong_clock(void);

/** Reports the interrupt that is the reason for EPG_MCU_ERROR_PRIORITY or EPG_FAULT_PRIORITY. */
void epg_mcu_report_priority(epg_mcu_priority_t priority);

/** The interrupt that was reported; its name is NULL if there was none since the newest start. */
const epg_mcu_priority_t *epg_mcu_wrong_priority(void);

/**
 * Runs the communication side as soon as possible.  For the interrupt of a transport, on the communication side's
 * core.
 */
void epg_mcu_service_wake(void);

/** Fills the words from `bottom` up to, but not including, `end` with a pattern. */
void epg_mcu_stack_paint(uint32_t *bottom, const uint32_t *end);

/**
 * The largest number of bytes of `stack` that have been in use since it was painted.  The lowest `unpainted` bytes are
 * ignored, because they were not painted.
 */
uint32_t epg_mcu_stack_used(const epg_mcu_stack_t *stack, uint32_t unpainted);

/** True if a painted stack has been used completely.  It may then have overflowed, too. */
bool epg_mcu_stack_full(const epg_mcu_stack_t *stack);

/* Between the platforms and their shared code ---------------------------------------------------------------------- */

/**
 * Keeps the communication side running while its middleware waits for bytes within `serve`: sends the bytes that the
 * middleware has written, calls `rest`, which must return soon, and serves the transports and the console.
 */
void epg_mcu_serve_others(void (*rest)(void));

/**
 * Starts to call `serve`, one turn of the communication side, at least once per millisecond.  Returns false if that
 * is not possible.  Each platform implements this function and the next two in its service.c.
 */
bool epg_mcu_service_start(void (*serve)(void));

/**
 * Stops the calls of `serve`.  When this returns true, `serve` is not running and is not called again.  Returns false
 * if the caller cannot wait for the end of `serve`.
 */
bool epg_mcu_service_stop(void);

/** Reports the stack on which `serve` runs: its size, and the largest number of bytes in use so far. */
void epg_mcu_service_stack(uint32_t *size, uint32_t *used);

#endif
