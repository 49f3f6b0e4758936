/**
 * @file
 * A DC motor with gear and load behind an H-bridge, for tests.
 */
#include "motor.h"

#include <math.h>

/* Motor constant, rotor and camera of JIWY's pan axis; 12 V over 12 ohm. */
static const double constant = 0.018;       /* N m/A and V s/rad */
static const double resistance = 12.0;      /* ohm */
static const double supply = 12.0;          /* V */
static const double gear = 1.0 / 19.0;      /* load/rotor */
static const double coulomb = 0.01 * 0.018; /* N m at the rotor: 1 % of the stall torque */

void motor_step(motor_t *motor, int direction, double duty, double seconds)
{
    const double inertia = 2.06e-7 + 3.0e-4 * gear * gear;
    const double viscous = 1.77e-6 + 2.0e-4 * gear * gear;
    const double voltage = (double)direction * duty * supply;
    motor->torque = direction == 0 ? 0.0 : constant * (voltage - constant * motor->speed) / resistance;

    const double driving = motor->torque - viscous * motor->speed;
    double speed = motor->speed + driving / inertia * seconds;
    /* Coulomb friction brakes the motor to rest, but never drives it. */
    const double brake = coulomb / inertia * seconds;
    speed = fabs(speed) <= brake ? 0.0 : speed - copysign(brake, speed);
    motor->speed = speed;
    motor->angle += speed * gear * seconds;
}
