/* A model without memory: what comes in goes out. */
#ifndef COPY_H
#define COPY_H

typedef struct {
    double angle, button, level, offset, speed;
} copy_inputs_t;

typedef struct {
    double angle_out, duty, heat, lamp, reset;
} copy_outputs_t;

void copy_step(const copy_inputs_t *inputs, copy_outputs_t *outputs);

#endif
