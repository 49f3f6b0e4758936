/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A controller that copies its setpoint to its output.
 */
#include "pass.h"

void pass_init(const pass_inputs_t *inputs, pass_outputs_t *outputs)
{
    pass_step(inputs, outputs);
}

void pass_step(const pass_inputs_t *inputs, pass_outputs_t *outputs)
{
    outputs->duty = inputs->setpoint;
}
