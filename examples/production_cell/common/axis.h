/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An axis with a motor and an encoder: a profile of limited speed and acceleration, PD control of the position, homing.
 * Positions are in m along the path of the axis.
 */
#ifndef AXIS_H
#define AXIS_H

#include <stdbool.h>

/** Step of all controllers of the cell, s. */
#define AXIS_STEP 0.002

/** Largest acceleration of the profile, m/s2. */
#define AXIS_ACCELERATION 1.0

/** Largest difference of the position at the end of a move, m. */
#define AXIS_TOLERANCE 0.003

typedef struct axis {
    double full_speed; /**< speed at the whole supply voltage, m/s: a parameter */
    double origin;     /**< encoder's position of the zero of this axis, m */
    double position;   /**< m from the origin */
    double speed;      /**< measured, m/s */
    double reference;  /**< position of the profile, m */
    double pace;       /**< speed of the profile, m/s */
    double blocked;    /**< time for which homing has not moved, s */
} axis_t;

/** Starts at the position of the encoder, which becomes the origin. */
void axis_start(axis_t *axis, double encoder);

/** Reads the encoder.  Must be called first in each step. */
void axis_read(axis_t *axis, double encoder);

/** Changes the speed of the profile towards `speed`. */
void axis_run(axis_t *axis, double speed);

/** Moves the profile towards `target` with at most `speed`. */
void axis_move(axis_t *axis, double target, double speed);

/** True if the axis rests at `target`. */
bool axis_is_at(const axis_t *axis, double target);

/** True if profile and axis rest. */
bool axis_is_still(const axis_t *axis);

/** Moves slowly in the negative direction.  Returns true when the end stop is reached: there is the origin then. */
bool axis_home(axis_t *axis);

/** The duty that follows the profile, -1 ... 1. */
double axis_duty(const axis_t *axis);

#endif
