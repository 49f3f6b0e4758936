#include "axis.h"

void axis_step(const axis_inputs_t *inputs, axis_outputs_t *outputs)
{
    const double step = 0.0005;
    outputs->speed += step * (20.0 * inputs->duty - outputs->speed) / 0.05;
    outputs->angle += step * outputs->speed;
}
