/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An axis under position control.
 */
#include "axis.h"

static const double gain = 40.0;         /* duty per m */
static const double damping = 0.5;       /* duty per m/s */
static const double largest_lag = 0.008; /* m between profile and axis, so that a blocked axis pushes gently */
static const double homing_speed = 0.05; /* m/s */
static const double homing_time = 0.2;   /* s without movement at the end stop */

static double limited(double value, double limit)
{
    return value > limit ? limit : value < -limit ? -limit : value;
}

static double size(double value)
{
    return value < 0.0 ? -value : value;
}

void axis_start(axis_t *axis, double encoder)
{
    axis->origin = encoder;
    axis->position = 0.0;
    axis->speed = 0.0;
    axis->reference = 0.0;
    axis->pace = 0.0;
    axis->blocked = 0.0;
}

void axis_read(axis_t *axis, double encoder)
{
    const double position = encoder - axis->origin;
    axis->speed = (position - axis->position) / AXIS_STEP;
    axis->position = position;
}

void axis_run(axis_t *axis, double speed)
{
    axis->pace += limited(speed - axis->pace, AXIS_ACCELERATION * AXIS_STEP);
    axis->reference += axis->pace * AXIS_STEP;
    axis->reference = axis->position + limited(axis->reference - axis->position, largest_lag);
}

void axis_move(axis_t *axis, double target, double speed)
{
    const double distance = target - axis->reference;
    const double change = AXIS_ACCELERATION * AXIS_STEP;
    if (size(distance) < change * AXIS_STEP && size(axis->pace) <= change) {
        axis->reference = target;
        axis->pace = 0.0;
        return;
    }
    const bool brakes =
        axis->pace * distance > 0.0 &&
        axis->pace * axis->pace >= 2.0 * AXIS_ACCELERATION * (size(distance) - size(axis->pace) * AXIS_STEP);
    const double pace = brakes ? change : speed; /* it creeps for the last part of a millimetre */
    axis_run(axis, distance > 0.0 ? pace : -pace);
}

bool axis_is_still(const axis_t *axis)
{
    return size(axis->pace) < 0.001 && size(axis->speed) < 0.002;
}

bool axis_is_at(const axis_t *axis, double target)
{
    return axis_is_still(axis) && size(axis->position - target) < AXIS_TOLERANCE;
}

bool axis_home(axis_t *axis)
{
    axis_run(axis, -homing_speed);
    const bool pushes = axis->position - axis->reference > 0.5 * largest_lag;
    axis->blocked = pushes && size(axis->speed) < 0.002 ? axis->blocked + AXIS_STEP : 0.0;
    if (axis->blocked < homing_time) {
        return false;
    }
    axis_start(axis, axis->origin + axis->position);
    return true;
}

double axis_duty(const axis_t *axis)
{
    const double duty = gain * (axis->reference - axis->position) + damping * (axis->pace - axis->speed);
    return limited(duty + axis->pace / axis->full_speed, 1.0);
}
