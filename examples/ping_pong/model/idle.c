/**
 * @file
 * A controller that only counts its steps.
 */
#include "idle.h"

void idle_init(idle_outputs_t *outputs)
{
    outputs->steps = 0.0;
}

void idle_step(idle_outputs_t *outputs)
{
    outputs->steps += 1.0;
}
