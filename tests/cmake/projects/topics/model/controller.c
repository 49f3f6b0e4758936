#include "controller.h"

void controller_init(const controller_inputs_t *inputs, controller_outputs_t *outputs)
{
    controller_step(inputs, outputs);
}

void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs)
{
    outputs->left_speed = inputs->forward - inputs->turn;
    outputs->right_speed = inputs->forward + inputs->turn;
    outputs->sum = inputs->number + inputs->right;
    outputs->moving = inputs->forward != 0.0 ? 1.0 : 0.0;
}
