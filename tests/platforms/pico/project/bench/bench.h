/**
 * @file
 * A controller that a test controls through variables.
 */
#ifndef BENCH_H
#define BENCH_H

typedef struct {
    double angle;
} bench_inputs_t;

typedef struct {
    double duty;
    double lamp;
} bench_outputs_t;

void bench_init(const bench_inputs_t *inputs, bench_outputs_t *outputs);
void bench_step(const bench_inputs_t *inputs, bench_outputs_t *outputs);

#endif
