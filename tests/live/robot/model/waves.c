/* SPDX-License-Identifier: Apache-2.0 */
#include "waves.h"

#include <math.h>

static double time_s;

void waves_init(const waves_inputs_t *inputs, waves_outputs_t *outputs)
{
    time_s = 0.0;
    waves_step(inputs, outputs);
}

void waves_step(const waves_inputs_t *inputs, waves_outputs_t *outputs)
{
    double *const waves[] = {&outputs->wave_1, &outputs->wave_2, &outputs->wave_3, &outputs->wave_4, &outputs->wave_5,
                             &outputs->wave_6, &outputs->wave_7, &outputs->wave_8, &outputs->wave_9};
    for (unsigned int n = 0; n < sizeof waves / sizeof waves[0]; n++) {
        *waves[n] = inputs->in_0 + sin((n + 1U) * time_s);
    }
    outputs->duty = 0.5;
    time_s += 0.001;
}
