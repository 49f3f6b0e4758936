#include "robot.h"

static double cycles;

void robot_init(const robot_inputs_t *inputs, robot_outputs_t *outputs)
{
    cycles = 0.0;
    robot_step(inputs, outputs);
}

void robot_step(const robot_inputs_t *inputs, robot_outputs_t *outputs)
{
    cycles += 1.0;
    outputs->got_reliable = inputs->reliable;
    outputs->got_quick = inputs->quick;
    outputs->got_held = inputs->held;
    outputs->got_zeroed = inputs->zeroed;
    outputs->cycles = cycles;
    outputs->cycles_too = cycles;
}
