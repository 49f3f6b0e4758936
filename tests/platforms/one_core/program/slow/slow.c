/* SPDX-License-Identifier: Apache-2.0 */
#include "slow.h"

void slow_init(const slow_inputs_t *inputs, slow_outputs_t *outputs)
{
    slow_step(inputs, outputs);
}

void slow_step(const slow_inputs_t *inputs, slow_outputs_t *outputs)
{
    outputs->duty = 0.5 - inputs->angle;
}
