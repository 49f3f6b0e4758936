/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What a family of chips brings to the platforms bare_metal and freertos, and what it gets from them.
 *
 * The platforms run the communication side, start and stop a target, watch stacks and keep the store's records.  A family
 * brings the registers: the tick and the control cycle in its interrupt, pins and peripherals (`epg/port.h`), outputs that
 * are safe, the watchdog, flash, transports.  Where the two sides run is the family's: on RP2040 and RP2350 control has
 * core 1 and communication core 0; on a chip with one core control is the interrupt of highest priority, and
 * communication runs below it.  Nothing here depends on that, since communication never waits for control.
 *
 * `epg/family_port.h`, a header of the family, defines what must be known to a compiler:
 *
 * | name                             | meaning |
 * |----------------------------------|---------|
 * | `epg_family_target_t`            | a target, generated: at least `target`, `transport`, `transport_title` and `console_transport`, as in `epg/pico.h` |
 * | `EPG_FAMILY_MIDDLEWARE_STACK`    | bytes of stack that middleware and console take; generated |
 * | `EPG_FAMILY_SERVICE_STACK_SIZE`  | bytes of the stack of communication on bare metal, where a user has set them; else undefined |
 * | `EPG_FAMILY_FPU_FRAME`           | bytes by which the frame of an exception is larger for the registers of an FPU |
 * | `EPG_FAMILY_SERVICE_TIMEOUT_MS`  | in which communication must have been served, or the watchdog is no longer fed |
 * | `EPG_FAMILY_STORE_CAPACITY`      | bytes of data that a sector of the store can hold, in front of its head |
 * | `epg_family_panic(format, ...)`  | makes outputs safe, says why where it can (NULL: nothing to say), never returns |
 * | `epg_family_sleep()`             | sleeps until an interrupt |
 * | `epg_family_in_interrupt()`      | whether the caller is an interrupt or exception |
 * | `epg_family_time_us()`           | low word of the microseconds since power-on: wraps, never stops |
 *
 * The last four can be functions or macros.
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

typedef struct epg_mcu_stack {
    uint32_t *bottom;
    uint32_t *top;
} epg_mcu_stack_t;

/* What a family brings: control --------------------------------------------------------------------------------- */

/** Whether a start is possible now; nothing has been started yet.  The place to verify clocks and priorities, too. */
epg_mcu_error_t epg_family_check_start(const epg_family_target_t *target);

/**
 * Starts the control loop, and returns when it waits for its first tick or when it has failed.
 *
 * Calls epg_control_start(), latches `fault` (what ended the run before this one, once per reset) and starts the
 * watchdog.  Afterwards the interrupt of a timer that repeats by itself calls epg_control_cycle() in every period, with
 * the time at which the tick was due and how many were missed (`epg/ticks.h`).  Nothing that a user installs can delay
 * the interrupt, and it calls no function of a kernel.  It feeds the watchdog only while epg_control_silence() is below
 * EPG_FAMILY_SERVICE_TIMEOUT_MS.
 */
epg_mcu_error_t epg_family_control_start(const epg_family_target_t *target, epg_fault_t fault);

/** Ends control: outputs are safe, peripherals given back and the watchdog off when this returns.  Also when it is off. */
void epg_family_control_stop(void);

/* What a family brings: safety ---------------------------------------------------------------------------------- */

/** What the run before this one has left behind: EPG_FAULT_NONE, EPG_FAULT_WATCHDOG or EPG_FAULT_PROCESSOR. */
epg_fault_t epg_family_fault_before_reset(void);

/** Puts a handler that makes outputs safe before the user's HardFault handler; may be called again. */
void epg_family_guard_faults(void);

/** The stack of main() and interrupts, and the one on which the control cycle runs: the same, if it has none of its own. */
extern const epg_mcu_stack_t epg_family_main_stack;
extern const epg_mcu_stack_t epg_family_control_stack;

/* What a family brings: communication on bare metal --------------------------------------------------------------- */

/**
 * Claims an interrupt of the lowest priority on the core of communication, with `handler` as its entry in the vector
 * table, and a timer that calls epg_mcu_service_wake() every `period_us` from an interrupt.  False: none is free.
 */
bool epg_family_service_claim(void (*handler)(void), uint32_t period_us);
void epg_family_service_release(void);

/** Makes that interrupt pending; from any interrupt. */
void epg_family_service_pend(void);

/* What a family brings: two sectors of flash ----------------------------------------------------------------------- */

/**
 * The bytes of a sector, 0 or 1: EPG_FAMILY_STORE_CAPACITY of data, then the head.  NULL while reading them would fault,
 * as it does where flash has ECC and a word was cut while it was programmed.
 */
const uint8_t *epg_family_store_sector(uint32_t index);

/**
 * Erases a sector, programs `size` bytes of `data` and last of all the head, each place once.  False when that is not
 * allowed now: the target is enabled, or the image lies there.
 */
bool epg_family_store_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size);

/* What a family can call ------------------------------------------------------------------------------------------ */

/** What the family's own functions for programs do: `epg_pico_start()` and so on.  From where communication runs. */
bool epg_mcu_start(const epg_family_target_t *target);
bool epg_mcu_stop(void);
void epg_mcu_status(epg_mcu_status_t *status);

/** Keeps `problem` as the error that epg_mcu_status() tells. */
void epg_mcu_report(epg_mcu_error_t problem);

/** Asks for communication at once: for the interrupt of a transport, on the core of communication. */
void epg_mcu_service_wake(void);

/** Fills the words from `bottom` to `end` with a pattern. */
void epg_mcu_stack_paint(uint32_t *bottom, const uint32_t *end);

/** Bytes that have ever been used of `stack`, whose first `unpainted` bytes are not looked at. */
uint32_t epg_mcu_stack_used(const epg_mcu_stack_t *stack, uint32_t unpainted);

/** Whether all of a painted stack has been used, and perhaps more. */
bool epg_mcu_stack_full(const epg_mcu_stack_t *stack);

/* Between the platforms and what they share ------------------------------------------------------------------------ */

/**
 * What `serve` does besides its middleware, which is waiting within it: sends what that has written, calls `rest`, which
 * returns soon, and serves transports and console.
 */
void epg_mcu_serve_others(void (*rest)(void));

/** Calls `serve` at least once per millisecond.  Each platform has this and the next two in its service.c. */
bool epg_mcu_service_start(void (*serve)(void));

/** `serve` is not running, nor called again, when this has returned true.  False when the caller cannot wait for it. */
bool epg_mcu_service_stop(void);

/** Fills in the stack on which `serve` runs. */
void epg_mcu_service_stack(uint32_t *size, uint32_t *used);

#endif
