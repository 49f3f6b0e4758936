/* A model without states: its outputs are its inputs. */
#ifndef COPY_H
#define COPY_H

#include <stdbool.h>

typedef struct {
    double angle, button, level, offset, speed;
    bool armed;
} copy_inputs_t;

typedef struct {
    double angle_out, duty, heat, lamp, reset;
    bool armed_out;
} copy_outputs_t;

void copy_step(const copy_inputs_t *inputs, copy_outputs_t *outputs);

#endif
