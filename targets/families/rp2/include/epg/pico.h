/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Raspberry Pi Pico (RP2040) and Pico 2 (RP2350): starting, stopping and monitoring a target.
 *
 * **Cores.**  Both chips have two processor cores.  Core 1 runs the control cycle and nothing else, so no other code
 * can delay it.  Core 0 runs main(), the communication side, and all interrupts and tasks of the user.
 *
 * **Tick.**  A PWM slice is a 16-bit counter that counts from 0 to TOP and then wraps to 0.  It counts the system
 * clock, clk_sys, divided by a prescaler.  One slice is reserved for the tick: each of its wraps raises an interrupt
 * on core 1, in which one control cycle runs.  The counter repeats by itself, so a tick can be late but is never
 * lost.
 *
 * **PWM outputs.**  Each other slice can drive two pins, channel A and channel B.  A pin is high while the counter is
 * below the channel's compare level.  The hardware takes over a new level at the next wrap (RP2040 data sheet 4.5.2.6).
 * The slices of the outputs start together with the slice of the tick.  If the control period is a whole number of PWM
 * periods, each tick comes at a wrap of the outputs' slices.
 *
 * **Encoders.**  A PIO block is a small processor for input and output, which works independently of the cores.  It has
 * four state machines.  With the program of a quadrature decoder, each of them counts the edges of one encoder.
 *
 * **Flash and RAM.**  While flash is written, no code can be read from it.  The control cycle therefore runs from RAM.
 *
 * **USB.**  If the target's transport is `usb`, or if it has a console, the chip is a USB device with one or two serial
 * ports (CDC ACM): one for the middleware, one for the console.
 *
 * A program contains one target.  The generated `<name>_start()` and `<name>_stop()` call the functions below:
 *
 *     #include "jiwy.h"
 *     #include "epg/pico.h"
 *
 *     if (!jiwy_start()) {
 *         epg_pico_status_t status;
 *         epg_pico_status(&status);
 *         printf("not started: error %d\n", (int)status.error);
 *         if (status.error == EPG_PICO_ERROR_CLOCK) {
 *             const epg_mcu_clock_t *clock = epg_pico_wrong_clock();
 *             printf("%s has %lu Hz\n", clock->name, (unsigned long)clock->found_hz);
 *         }
 *     }
 *
 * This header includes no header of the Pico SDK, because generated code includes it.
 */
#ifndef EPG_PICO_H
#define EPG_PICO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/mcu.h"
#include "epg/middleware.h"
#include "epg/target.h"
#include "epg/transport.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A pin that a component drives. */
typedef struct epg_pico_output {
    uint8_t pin; /**< GPIO number, 0 ... 29 */
    bool high;   /**< safe level of the pin */
} epg_pico_output_t;

/** The pins that all components of a target drive. */
typedef struct epg_pico_outputs {
    size_t count;
    const epg_pico_output_t *pins;
} epg_pico_outputs_t;

/**
 * The PWM slice that makes the tick.  One control period is `prescaler * (top + 1)` periods of clk_sys.
 *
 * Example: at 125 MHz, prescaler 2 and top 62499 give 2 * 62500 = 125000 clocks, which is a control period of 1 ms.
 */
typedef struct epg_pico_tick {
    uint8_t slice;      /**< 0 ... 7 on RP2040, 0 ... 11 on RP2350A */
    uint16_t prescaler; /**< 1 ... 255: integer part of the slice's divider */
    uint16_t top;       /**< largest value of the counter */
} epg_pico_tick_t;

/** A target with its tick and transports; generated. */
typedef struct epg_pico_target {
    const epg_target_t *target;
    uint32_t clock;      /**< Hz of clk_sys for which the generator computed the dividers of the PWM slices */
    uint32_t uart_clock; /**< Hz of clk_peri for which it computed the dividers of UARTs; 0 without a UART */
    epg_pico_tick_t tick;
    const epg_transport_t *transport;         /**< of the target's middleware; NULL if it needs none */
    const char *transport_title;              /**< name of the transport for the user, for example "EPG ROS 2" */
    const epg_transport_t *console_transport; /**< of a console beside another middleware; NULL if there is none */
} epg_pico_target_t;

/** The reason why epg_pico_start() or epg_pico_stop() failed, or why the program could not use core 1. */
typedef epg_mcu_error_t epg_pico_error_t;

#define EPG_PICO_OK EPG_MCU_OK
#define EPG_PICO_ERROR_RUNNING EPG_MCU_ERROR_RUNNING       /**< a target is running already */
#define EPG_PICO_ERROR_CLOCK EPG_MCU_ERROR_CLOCK           /**< a clock is wrong: epg_pico_wrong_clock() */
#define EPG_PICO_ERROR_PLACEMENT EPG_MCU_ERROR_PLACEMENT   /**< the control cycle is in flash, not in RAM */
#define EPG_PICO_ERROR_RESOURCE EPG_MCU_ERROR_RESOURCE     /**< a PIO block, alarm, UART or interrupt is in use */
#define EPG_PICO_ERROR_CORE EPG_MCU_ERROR_CORE             /**< core 1 did not answer */
#define EPG_PICO_ERROR_CALLER EPG_MCU_ERROR_CALLER         /**< epg_pico_stop() was called where it cannot wait */
#define EPG_PICO_ERROR_CORE_TAKEN EPG_MCU_ERROR_CORE_TAKEN /**< the program uses core 1, or has tried to */

/** Measurements of the port layer.  The control cycle has core 1's stack; main() and interrupts have core 0's stack. */
typedef epg_mcu_status_t epg_pico_status_t;

/** The transport `usb`: the first serial port of the USB device.  It is linked only if a target uses it. */
extern const epg_transport_t epg_usb;
#define epg_pico_usb epg_usb
/** The second serial port.  A device has it if the first port belongs to a middleware and the target has a console. */
extern const epg_transport_t epg_usb_second;
#define epg_pico_usb_second epg_usb_second

/** All outputs of the target; generated.  They are made safe before main() and after each fault. */
extern const epg_pico_outputs_t epg_pico_outputs;

/**
 * Starts the control side on core 1, then the communication side on core 0.  Returns true when core 1 waits for its
 * first tick.  The outputs stay safe until the target is enabled.
 *
 * Returns false, with all outputs safe, if the target cannot start; epg_pico_status() then reports the reason.
 *
 * Must be called on core 0.  On FreeRTOS it may be called before or after the scheduler starts.
 */
bool epg_pico_start(const epg_pico_target_t *pico);

/**
 * Stops the communication side and the control side.  When this returns true, all outputs are safe and core 1 is in
 * reset; epg_pico_start() may be called again.  Returns true, too, if no target is running.
 *
 * Must be called on core 0, on FreeRTOS from a task.  It waits for the end of the communication side's turn.  Three
 * callers cannot wait for this: the communication side itself (for example a callback of TinyUSB), an interrupt, and
 * a FreeRTOS task that has suspended the scheduler.  For them it returns false, and the target goes on.
 */
bool epg_pico_stop(void);

/**
 * Fills `status`.  It reads all stacks, which takes too long for an interrupt.  Must be called on core 0.
 */
void epg_pico_status(epg_pico_status_t *status);

/** The reason for EPG_PICO_ERROR_CLOCK.  Its name is NULL if the newest start has found no wrong clock. */
const epg_mcu_clock_t *epg_pico_wrong_clock(void);

/**
 * Makes all outputs safe until the next reset.  For fault handlers: it uses registers only, and needs no interrupt
 * and no other core.  Each pin becomes a plain output at its safe level.  If the caller is core 0, core 1 is held in
 * reset, so that it cannot write its outputs again.
 */
void epg_pico_safe_state(void);

#ifdef __cplusplus
}
#endif

#endif
