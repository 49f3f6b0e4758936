#include "bench.h"

static int steps;

static void show(bench_outputs_t *outputs)
{
    outputs->angle = 0.36 * steps; /* deg: one revolution a second */
    outputs->button = steps >= 200;
    outputs->emergency = steps < 400; /* the contact is closed */
}

void bench_init(const bench_inputs_t *inputs, bench_outputs_t *outputs)
{
    (void)inputs;
    steps = 0;
    show(outputs);
}

void bench_step(const bench_inputs_t *inputs, bench_outputs_t *outputs)
{
    (void)inputs;
    steps++;
    show(outputs);
}
