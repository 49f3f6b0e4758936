/**
 * @file
 * A model whose outputs show if they belong to its inputs.  An input, an output and a parameter share names.
 */
#ifndef MIRROR_H
#define MIRROR_H

typedef struct {
    double x;
    double speed;
    double again;
    double one;
} mirror_inputs_t;

typedef struct {
    double x;
    double twice;
    double steps;
    double product;
} mirror_outputs_t;

typedef struct {
    double gain;
    double offset;
    double count;
} mirror_t;

void mirror_init(mirror_t *self, const mirror_inputs_t *inputs, mirror_outputs_t *outputs);
void mirror_step(mirror_t *self, const mirror_inputs_t *inputs, mirror_outputs_t *outputs);

#endif
