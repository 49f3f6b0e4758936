#include "pendulum.h"

#include <math.h>

/* The state begins at the input of the enabling. */
void pendulum_init(pendulum_t *self, const pendulum_inputs_t *inputs, pendulum_outputs_t *outputs)
{
    self->angle = inputs->torque;
    self->speed = 0.0;
    self->time = 0.0;
    outputs->angle = self->angle;
    outputs->time = 0.0;
}

void pendulum_step(pendulum_t *self, const pendulum_inputs_t *inputs, pendulum_outputs_t *outputs)
{
    const double acceleration = inputs->torque - self->stiffness * sin(self->angle) - self->damping * self->speed;
    self->speed += 0.002 * acceleration;
    self->angle += 0.002 * self->speed;
    self->time += 0.002;
    outputs->angle = self->angle;
    outputs->time = self->time;
}
