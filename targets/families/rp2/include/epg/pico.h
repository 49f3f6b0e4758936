/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Raspberry Pi Pico: what a generated target and the port layer know of each other.
 *
 * Free of the Pico SDK, as generated code is.  Core 1 runs the control cycle in the wrap interrupt of a reserved PWM
 * slice and does nothing else; core 0 belongs to communication and to the user.  One target per executable.
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

/** A pin that a component drives, and its level while nothing is to move. */
typedef struct epg_pico_output {
    uint8_t pin;
    bool high;
} epg_pico_output_t;

typedef struct epg_pico_outputs {
    size_t count;
    const epg_pico_output_t *pins;
} epg_pico_outputs_t;

/** The PWM slice whose wrap is the tick: `prescaler * (top + 1)` clocks are one control period. */
typedef struct epg_pico_tick {
    uint8_t slice;
    uint16_t prescaler;
    uint16_t top;
} epg_pico_tick_t;

/** A target as its port layer runs it. */
typedef struct epg_pico_target {
    const epg_target_t *target;
    uint32_t clock; /**< Hz of clk_sys, which all dividers were computed for */
    epg_pico_tick_t tick;
    const epg_transport_t *transport; /**< for the target's middleware; NULL: it needs none */
    const char *transport_title;
    const epg_transport_t *console_transport; /**< for the console beside it; NULL: there is none */
} epg_pico_target_t;

/** Why epg_pico_start() did not start, epg_pico_stop() did not stop, or the program did not get core 1. */
typedef epg_mcu_error_t epg_pico_error_t;

#define EPG_PICO_OK EPG_MCU_OK
#define EPG_PICO_ERROR_RUNNING EPG_MCU_ERROR_RUNNING
#define EPG_PICO_ERROR_CLOCK EPG_MCU_ERROR_CLOCK           /**< of clk_sys */
#define EPG_PICO_ERROR_PLACEMENT EPG_MCU_ERROR_PLACEMENT   /**< in flash */
#define EPG_PICO_ERROR_RESOURCE EPG_MCU_ERROR_RESOURCE     /**< a PIO block, an alarm, a UART or an interrupt */
#define EPG_PICO_ERROR_CORE EPG_MCU_ERROR_CORE             /**< core 1 */
#define EPG_PICO_ERROR_CALLER EPG_MCU_ERROR_CALLER         /**< of epg_pico_stop() */
#define EPG_PICO_ERROR_CORE_TAKEN EPG_MCU_ERROR_CORE_TAKEN /**< core 1 */

/** What the port layer counts.  Control runs on core 1's stack, main() and interrupts use core 0's. */
typedef epg_mcu_status_t epg_pico_status_t;

/** The transport over USB CDC, in usb/, linked where a target uses it: the first serial port of the device, */
extern const epg_transport_t epg_pico_usb;
/** and the second one, which a device has whose first one is not the console's. */
extern const epg_transport_t epg_pico_usb_second;

/** All outputs of the target in this executable; generated.  They are made safe before main() and after each fault. */
extern const epg_pico_outputs_t epg_pico_outputs;

/**
 * Starts the control loop on core 1, then communication on core 0.  Call it from core 0, on FreeRTOS before or after
 * the scheduler starts.  Returns when core 1 waits for its first tick; false, with all outputs safe, when that is
 * impossible: epg_pico_status() says why.
 */
bool epg_pico_start(const epg_pico_target_t *pico);

/**
 * Ends communication and control; outputs are safe and core 1 is in reset when this returns.  epg_pico_start() may
 * follow.  Call it from core 0; on FreeRTOS from a task, which waits until communication has come to the end of its turn.
 *
 * False, and everything goes on, when the caller is communication itself (a callback of TinyUSB, for example), an
 * interrupt, or, on FreeRTOS, a task that has suspended the scheduler: these cannot wait for communication.
 */
bool epg_pico_stop(void);

/** Fills `status`; takes as long as reading all stacks does, so not from an interrupt.  Core 0. */
void epg_pico_status(epg_pico_status_t *status);

/**
 * Makes all outputs safe for good, by registers alone: pins become plain outputs at their safe levels, and unless
 * this is core 1, core 1 is held in reset.  For fault handlers; only a reset leads out of it.
 */
void epg_pico_safe_state(void);

#ifdef __cplusplus
}
#endif

#endif
