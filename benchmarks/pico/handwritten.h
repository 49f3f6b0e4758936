/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * JIWY's control and communication, written by hand for the Pico SDK.
 *
 * handwritten.c is what happens in a control cycle, communication.c a line protocol over the SDK's stdio; main_*.c say
 * what makes the tick.  The model and the encoder library are those of the generated target.
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

/** Encoders, PWM, model.  On the core that controls; the slices start with one write, those in `more` with them. */
void control_start(uint32_t more);
/** One cycle, of the tick at `due_us`. */
void control_cycle(uint32_t due_us);

/* From the other side. */
void control_setpoints(const double setpoints[AXES]);
void control_positions(double positions[AXES]);
void control_statistics(statistics_t *statistics);
void control_enable(bool enable);

/** Serves the serial port once: commands that have come, positions every `communication_period_us`. */
void communicate(void);
extern volatile uint32_t communication_period_us;

#endif
