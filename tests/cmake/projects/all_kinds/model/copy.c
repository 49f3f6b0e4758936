#include "copy.h"

void copy_step(const copy_inputs_t *inputs, copy_outputs_t *outputs)
{
    outputs->angle_out = inputs->angle;
    outputs->armed_out = inputs->armed;
    outputs->duty = inputs->speed;
    outputs->heat = inputs->level;
    outputs->lamp = inputs->button;
    outputs->reset = inputs->level >= 2.0 ? 1.0 : 0.0;
}
