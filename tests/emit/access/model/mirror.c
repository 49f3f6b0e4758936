#include "mirror.h"

void mirror_init(mirror_t *self, const mirror_inputs_t *inputs, mirror_outputs_t *outputs)
{
    (void)inputs;
    (void)outputs;
    self->count = 0.0;
}

void mirror_step(mirror_t *self, const mirror_inputs_t *inputs, mirror_outputs_t *outputs)
{
    self->count += 1.0;
    outputs->x = inputs->x;
    outputs->twice = 2.0 * inputs->x;
    outputs->steps = self->count;
    outputs->product = self->gain * inputs->one + self->offset;
}
