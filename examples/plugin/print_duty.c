/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>

#include "position.h"

int main(void)
{
    position_t *model = position_instance(0);
    position_inputs_t inputs = {0.4}; /* counts: the model gets the nearest whole number */
    position_outputs_t outputs;

    position_init(model, &inputs, &outputs);
    printf("0 ms: %g\n", outputs.duty);
    for (int step = 1; step <= 20; step++) {
        position_step(model, &inputs, &outputs);
        printf("%d ms: %g\n", step, outputs.duty);
    }
    inputs.angle = 1e6; /* more than an int16_t holds */
    position_step(model, &inputs, &outputs);
    printf("limited: %g, %lu\n", outputs.duty, position_clamped(model));
    position_init(model, &inputs, &outputs);
    printf("again: %g\n", outputs.duty);
    return 0;
}
