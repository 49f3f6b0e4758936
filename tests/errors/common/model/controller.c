#include "controller.h"

void controller_init(const controller_inputs_t *inputs, controller_outputs_t *outputs)
{
    controller_step(inputs, outputs);
}

void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs)
{
    outputs->duty = inputs->go > 0.5 ? inputs->setpoint - inputs->angle : 0.0;
    outputs->log = inputs->angle;
    outputs->reset = 0.0;
}
