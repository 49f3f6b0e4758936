/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The part of `epg/family.h` that all families of chips with one Cortex-M3, M4 or M7 core share.
 *
 * On such a chip the control side is the interrupt of a timer, the tick.  The tick has the highest priority of all
 * interrupts, 0: above USB, DMA, HAL's tick, and everything that a kernel masks by BASEPRI.  It calls no function of a
 * kernel, and has its own stack.  The communication side runs below it: on bare metal in an interrupt that only
 * software makes pending, on FreeRTOS in a task.
 *
 * These files implement the functions of `epg/family.h` for control, for faults and for the communication of bare
 * metal, and from `epg/port.h` epg_port_time_ns() and epg_port_wait_until().  They use the registers of the core only
 * (Armv7-M Architecture Reference Manual, DDI 0403): NVIC, SCB, SysTick, FPU.  The family implements the functions below
 * with the registers of its chips, and all other functions of `epg/port.h` and `epg/family.h`.
 *
 * `epg/family_port.h` must include the family's device header, then `epg/one_core_port.h`, and define
 *
 * - `EPG_ONE_CORE_INTERRUPTS`: the number of interrupts of the chip, without the 16 exceptions of the core
 * - `EPG_ONE_CORE_TIME_NS`: the resolution of epg_one_core_time_ns() in nanoseconds
 * - `EPG_ONE_CORE_CLOCK_INTERRUPT`: the interrupt of the timer behind epg_one_core_time_ns()
 * - `EPG_ONE_CORE_CORE_HZ`: an expression: the clock of the core in Hz, read from registers
 * - `EPG_ONE_CORE_HOLD_MS`: the longest time of a write to flash in milliseconds, the erasure of a sector included
 * - `EPG_ONE_CORE_CONTROL_STACK_SIZE`: optional: bytes of the control cycle's stack
 * - `EPG_ONE_CORE_WATCHDOG_MS`: optional: shortest time of the watchdog
 *
 * `family.cmake` includes `one_core.cmake`, which lists the functions to call.
 */
#ifndef EPG_ONE_CORE_H
#define EPG_ONE_CORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/family.h"

/* Brought by a family: the tick ---------------------------------------------------------------------------------- */

/** The interrupt of the tick's timer. */
IRQn_Type epg_one_core_tick_interrupt(const epg_family_target_t *target);

/**
 * Clears an old request of the tick's timer, and starts it together with the timers of all PWM outputs.  The first tick
 * comes one control period later.  The timer repeats by itself.  The interrupt is disabled in the NVIC during this call.
 */
void epg_one_core_tick_start(const epg_family_target_t *target);

/**
 * Clears the tick's interrupt in the timer, so that a later tick raises it again.  When it returns, the NVIC no longer
 * sees the request that was cleared.
 */
void epg_one_core_tick_clear(const epg_family_target_t *target);

/** The result of epg_one_core_tick_ns() if the counter alone does not show the time. */
#define EPG_ONE_CORE_TICK_PASSED UINT32_MAX

/**
 * Nanoseconds since the tick whose interrupt runs, by the timer's counter.  EPG_ONE_CORE_TICK_PASSED if a further tick
 * has come since epg_one_core_tick_clear(), or if a period has 2^32 nanoseconds or more.
 */
uint32_t epg_one_core_tick_ns(const epg_family_target_t *target);

/** Stops the timers that epg_one_core_tick_start() has started, and gives all peripherals of the target back. */
void epg_one_core_tick_stop(const epg_family_target_t *target);

/**
 * False if a peripheral that was started belongs to other code.  Asked once after epg_control_start() has started all
 * peripherals; the next start begins with true again.
 */
bool epg_one_core_resources_free(void);

/**
 * A timer that is not the tick's and that never stops: nanoseconds since the first call.  It extends its counter
 * in its own interrupt, EPG_ONE_CORE_CLOCK_INTERRUPT, whose priority is 1 or 0.  May be called from every context, also
 * above the priority of that interrupt, so it must see a wrap whose interrupt is pending.  epg_family_control_start()
 * calls it before the tick starts.  The time shows how many ticks were missed.
 */
uint64_t epg_one_core_time_ns(void);

/* Brought by a family: safety ------------------------------------------------------------------------------------ */

/**
 * Makes the pin of each output a plain output at its safe level, by registers only.  It is called before main(), from
 * fault handlers, and when the target stops.
 */
void epg_one_core_outputs_safe(void);

/**
 * Starts the watchdog, which resets the chip after `timeout_ms` without epg_one_core_watchdog_feed().  Does nothing if
 * the user's program has started it: it then belongs to the user, and the two functions below do nothing either.
 */
void epg_one_core_watchdog_start(uint32_t timeout_ms);

/** Feeds the watchdog.  Called from the tick. */
void epg_one_core_watchdog_feed(void);

/**
 * The target has stopped.  Switches the watchdog off.  Many watchdogs cannot be switched off: the family feeds such a one
 * from then on in the interrupt of its clock, until the next epg_one_core_watchdog_start().
 */
void epg_one_core_watchdog_stop(void);

/**
 * Remembers over a reset that a processor fault has ended the run.  Called from the fault handler, with outputs safe;
 * epg_family_fault_before_reset() of the family reads it.
 */
void epg_one_core_remember_fault(void);

/**
 * Interrupts of the chip that no peripheral in use raises, for the communication side of bare metal.  A constant list,
 * in the order of preference, which ends with a negative number.  The first one that is disabled is used.
 */
extern const IRQn_Type epg_one_core_spare_interrupts[];

/**
 * The name of an interrupt for messages ("TIM6_DAC"), or NULL if there is none.  Used to name an interrupt whose
 * priority is too high.
 */
const char *epg_one_core_interrupt_name(int32_t interrupt);

/* Brought by these files ------------------------------------------------------------------------------------------- */

typedef void (*epg_one_core_handler_t)(void);

/**
 * Replaces the handler of an interrupt or exception, in a copy of the vector table in RAM.  The first call makes the
 * copy: it reads the table at VTOR, so the handlers of the user's file stay.  Returns the handler that was there.
 */
epg_one_core_handler_t epg_one_core_set_handler(IRQn_Type interrupt, epg_one_core_handler_t handler);

/**
 * Enables `interrupt`, with `handler`, at the highest priority below the tick's at which functions of a kernel can be
 * called.  For transports.  A request that is pending already stays: a byte may have arrived.
 */
void epg_one_core_enable(IRQn_Type interrupt, epg_one_core_handler_t handler);

/** Disables `interrupt` and puts the handler back that epg_one_core_enable() has replaced. */
void epg_one_core_disable(IRQn_Type interrupt);

/**
 * For a write to flash, which the communication side waits for: until epg_one_core_release(), the tick feeds the watchdog
 * although the communication side is silent, but for EPG_ONE_CORE_HOLD_MS at most.  The control cycle goes on.
 *
 * Returns false if the running target is enabled; the flash must then not be written.  Returns true if no target runs.
 */
bool epg_one_core_hold(void);

/** Ends what epg_one_core_hold() has begun. */
void epg_one_core_release(void);

/**
 * The enabled interrupt that could delay the tick, other than the tick itself and the clock; `name` is NULL if there
 * is none.  Reads the NVIC, SysTick and PRIGROUP.  epg_family_control_start() refuses to start with one, and once per
 * second the communication side looks again.
 *
 * Exceptions of the core are left out.  Faults end the run.  A kernel uses PendSV at the lowest priority.  SVCall is a
 * call by the program; FreeRTOS makes one, when it starts its first task.
 */
epg_mcu_priority_t epg_one_core_check_priorities(void);

/**
 * Lets the tick call `pend` about once per millisecond, or in every control period if that is longer.  NULL: no more.
 * `pend` must only make an interrupt pending.
 */
void epg_one_core_pend_service(void (*pend)(void));

/** True if the control period is longer than a millisecond. */
bool epg_one_core_slow(void);

/** Ends control for good, after a fault of the processor: no more control cycles, and the watchdog is no longer fed. */
void epg_one_core_end(void);

/** Priority of the interrupts of transports, as for NVIC_SetPriority(): each platform has its own. */
extern const uint32_t epg_one_core_transport_priority;

#endif
