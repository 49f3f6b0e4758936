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

#define PERIOD_US 1000

enum { PAN, TILT, AXES };

typedef struct statistics {
    uint32_t cycles;
    uint32_t overruns;
    uint32_t missed;
    uint32_t computation_max_us;
    bool enabled;
} statistics_t;

/**
 * Starts encoders and PWM, on the core that runs the control cycles.  All PWM slices start in one write, together with
 * the slices whose bits are set in `more`.
 */
void control_start(uint32_t more);
/** Runs one cycle.  `due_us` is the time of its tick. */
void control_cycle(uint32_t due_us);

/* Functions for the communication side. */
void control_setpoints(const double setpoints[AXES]);
void control_positions(double positions[AXES]);
void control_statistics(statistics_t *statistics);
void control_enable(bool enable);

/** Serves the serial port once: reads commands, and prints positions every `communication_period_us`. */
void communicate(void);
extern volatile uint32_t communication_period_us;

#endif
