/**
 * @file
 * A DC motor with gear and load behind an H-bridge, for tests: JIWY's pan axis without its end stops.
 */
#ifndef MOTOR_H
#define MOTOR_H

typedef struct motor {
    double speed;  /**< rad/s of the rotor */
    double angle;  /**< rad of the load */
    double torque; /**< torque of the motor in N m, due to the bridge */
} motor_t;

/**
 * Advances the motor by `seconds` (at most 1e-4).  `direction` and `duty` are the bridge's pins: 1 or -1 drives with
 * `duty` (0 ... 1) of the supply; with 0 the bridge is open, no current flows and the motor coasts.
 */
void motor_step(motor_t *motor, int direction, double duty, double seconds);

#endif
