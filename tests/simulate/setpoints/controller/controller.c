#include "controller.h"

/** Drives an axis that turns at 20 rad/s at full duty: at `speed`, or to `target`, whichever is bound to a topic. */
void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs)
{
    outputs->duty = inputs->speed / 20.0 + 0.25 * (inputs->target - inputs->position);
}
