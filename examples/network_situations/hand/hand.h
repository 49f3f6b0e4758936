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
    double duty_seen;   /**< largest duty so far; 0 if the motors were never on */
} hand_outputs_t;

void hand_init(const hand_inputs_t *inputs, hand_outputs_t *outputs);
void hand_step(const hand_inputs_t *inputs, hand_outputs_t *outputs);

#endif
