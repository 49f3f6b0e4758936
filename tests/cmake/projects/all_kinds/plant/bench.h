/* A bench: the shaft turns at a constant speed, a button is pressed after 0.2 s, the emergency stop opens after 0.4 s. */
#ifndef BENCH_H
#define BENCH_H

typedef struct {
    double duty, heat, lamp;
} bench_inputs_t;

typedef struct {
    double angle, button, emergency;
} bench_outputs_t;

void bench_init(const bench_inputs_t *inputs, bench_outputs_t *outputs);
void bench_step(const bench_inputs_t *inputs, bench_outputs_t *outputs);

#endif
