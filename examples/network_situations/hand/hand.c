#include "hand.h"

#include <math.h>

static const double step = 0.001;  /* s */
static const double begin = 2.5;   /* s */
static const double period = 3.0;  /* s, forwards and back */
static const double height = 3.14; /* rad */

static double seconds;

void hand_init(const hand_inputs_t *inputs, hand_outputs_t *outputs)
{
    (void)inputs;
    seconds = 0.0;
    outputs->angle_left = 0.0;
    outputs->angle_right = 0.0;
    outputs->duty_seen = 0.0;
}

void hand_step(const hand_inputs_t *inputs, hand_outputs_t *outputs)
{
    seconds += step;
    const double turned =
        seconds < begin ? 0.0 : height * 0.5 * (1.0 - cos(6.283185307179586 * (seconds - begin) / period));
    outputs->angle_left = turned;
    outputs->angle_right = 0.5 * turned;
    outputs->duty_seen = fmax(outputs->duty_seen, fmax(fabs(inputs->duty_left), fabs(inputs->duty_right)));
}
