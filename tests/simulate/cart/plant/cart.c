#include "cart.h"

void cart_step(const cart_inputs_t *inputs, cart_outputs_t *outputs)
{
    const double step = 0.0005;
    outputs->speed += step * (20.0 * inputs->duty - outputs->speed) / 0.05;
    outputs->angle += step * outputs->speed;
    outputs->contact = 1.0;
}
