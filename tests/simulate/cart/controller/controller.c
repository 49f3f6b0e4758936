#include "controller.h"

void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs)
{
    outputs->duty = inputs->setpoint / 20.0;
}
