/**
 * @file
 * Wheels that are turned by hand: forwards and back, the right one half as far.
 */
#ifndef HAND_H
#define HAND_H

typedef struct {
    double duty_left;
    double duty_right;
} hand_inputs_t;

typedef struct {
    double angle_left;  /**< rad */
    double angle_right; /**< rad */
    double duty_seen;   /**< largest there has been: 0 says that the motors have been off all the time */
} hand_outputs_t;

void hand_init(const hand_inputs_t *inputs, hand_outputs_t *outputs);
void hand_step(const hand_inputs_t *inputs, hand_outputs_t *outputs);

#endif
