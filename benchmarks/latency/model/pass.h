/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A controller that copies its setpoint to its output.
 */
#ifndef PASS_H
#define PASS_H

typedef struct {
    double setpoint;
} pass_inputs_t;

typedef struct {
    double duty;
} pass_outputs_t;

void pass_init(const pass_inputs_t *inputs, pass_outputs_t *outputs);
void pass_step(const pass_inputs_t *inputs, pass_outputs_t *outputs);

#endif
