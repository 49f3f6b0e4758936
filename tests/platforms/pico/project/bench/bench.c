#include "bench.h"

#include <math.h>
#include <stdint.h>

/* The test writes these. */
volatile uint32_t bench_loops; /* determines the duration of a step */
volatile uint32_t bench_not_finite;
volatile uint32_t bench_fault;
volatile uint32_t bench_depth; /* calls of a function by itself, each with 100 bytes of stack or more */
volatile uint32_t bench_functions;
volatile double bench_duty = 0.25;

void bench_init(const bench_inputs_t *inputs, bench_outputs_t *outputs)
{
    (void)inputs;
    outputs->duty = 0.0;
    outputs->lamp = 0.0;
}

static uint32_t deeper(uint32_t depth)
{
    volatile uint32_t space[24] = {depth};
    return depth == 0U ? 0U : deeper(depth - 1U) + space[0];
}

/* All functions of math.h that an exported model can call. */
static double functions(double x)
{
    return sin(x) + cos(x) + tan(x) + asin(x) + acos(x) + atan(x) + atan2(x, 0.5) + sinh(x) + cosh(x) + tanh(x) +
           asinh(x) + acosh(x) + atanh(x) + exp(x) + log(x) + log10(x) + pow(x, 0.5) + sqrt(x) + cbrt(x) +
           hypot(x, 0.5) + floor(x) + ceil(x) + round(x) + trunc(x) + fmod(x, 0.5) + ldexp(x, 2) + fabs(x);
}

void bench_step(const bench_inputs_t *inputs, bench_outputs_t *outputs)
{
    for (uint32_t loop = 0; loop < bench_loops; loop++) {
        __asm volatile("nop");
    }
    if (bench_fault != 0U) {
        *(volatile uint32_t *)0xF0000000U = 0;
    }
    (void)deeper(bench_depth);
    outputs->duty = bench_not_finite != 0U ? 0.0 / (inputs->angle - inputs->angle) : bench_duty;
    if (bench_functions != 0U) {
        outputs->duty = functions(inputs->angle);
    }
    outputs->lamp = 1.0;
}
