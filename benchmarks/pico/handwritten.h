/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * JIWY's control and communication, written by hand for the Pico SDK.
 *
 * handwritten.c is the control cycle, communication.c a line protocol over the SDK's stdio, and each main_*.c another
 * source of the tick.  The model and the encoder library are the same as in the generated target.
 */
#ifndef HANDWRITTEN_H
#define HANDWRITTEN_H

#include <stdbool.h>
#include <stdint.h>

#include "hardware/clocks.h"

#define PERIOD_US 1000
#define CLOCKS_PER_US (SYS_CLK_HZ / 1000000u)

enum { PAN, TILT, AXES };
enum { POSITION, SETPOINT = 2, INPUTS = 4 };
enum { RESET, LOGGING_PAN = 2, DUTY = 3, LOGGING_TILT = 5, OUTPUTS = 6 };

typedef enum fault {
    FAULT_NONE,
    FAULT_NOT_FINITE, /* an input, a state or an output of the model is NaN or infinite */
    FAULT_STOPPED,    /* the model asked to stop */
    FAULT_OVERRUN,
    FAULT_SENSOR,        /* a decoder has stopped */
    FAULT_STALL,         /* a driven axis does not move */
    FAULT_RUNAWAY,       /* an axis moves against its drive */
    FAULT_HOMING_TRAVEL, /* homing went too far */
    FAULT_HOMING_TIME    /* homing took too long */
} fault_t;

/** Times are in clocks of clk_sys. */
typedef struct statistics {
    uint32_t cycles;
    uint32_t overruns;     /**< cycles that ended after the next tick, or that began after missed ticks */
    uint32_t missed;       /**< ticks without a cycle */
    uint32_t lateness_max; /**< from a tick to the start of its cycle */
    uint32_t computation_min;
    uint32_t computation_max;
    uint64_t computation_total;
    uint32_t clamped; /**< duties that were limited */
    uint32_t dropped; /**< setpoints that were not finite */
    uint32_t faults;
    uint32_t silence_max; /**< most cycles between two turns of the communication side */
} statistics_t;

typedef struct status {
    bool enabled;
    uint8_t fault; /**< the first fault since the target was enabled: a fault_t */
    uint8_t axis;  /**< the axis with the fault; AXES: both */
    statistics_t statistics;
} status_t;

/** Everything that a cycle tells the communication side. */
typedef struct report {
    double inputs[INPUTS];
    double outputs[OUTPUTS];
    uint32_t due_us; /**< time of the tick */
    status_t status;
} report_t;

/**
 * Starts encoders and PWM, on the core that runs the control cycles.  All PWM slices start in one write, together with
 * the slices whose bits are set in `more`.
 */
void control_start(uint32_t more);
/**
 * Runs one cycle.  `due_us` is the time of its tick, `lateness` the clocks since then, and `missed` the number of ticks
 * without a cycle before it.
 */
void control_cycle(uint32_t due_us, uint32_t lateness, uint32_t missed);
/** The clocks from `due_us` to `now_us`. */
static inline uint32_t clocks_late(uint32_t due_us, uint32_t now_us)
{
    return (int32_t)(now_us - due_us) > 0 ? (now_us - due_us) * CLOCKS_PER_US : 0u;
}

/* Functions for the communication side. */
void control_setpoint(uint32_t axis, double value);
/** Returns false before the first cycle. */
bool control_report(report_t *report);
/** Enabling clears a fault. */
void control_enable(bool enable);
/** Must be called in each turn.  Without turns, the watchdog resets the chip. */
void control_alive(void);

/** Serves the serial port once: reads commands, and prints positions every `communication_period_us`. */
void communicate(void);
extern volatile uint32_t communication_period_us;

#endif
