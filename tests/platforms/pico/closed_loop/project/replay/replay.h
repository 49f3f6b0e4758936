/**
 * @file
 * A plant whose angles were recorded.
 */
#ifndef REPLAY_H
#define REPLAY_H

#include <stddef.h>

typedef struct {
    double duty_pan;
    double duty_tilt;
} replay_inputs_t;

typedef struct {
    double angle_pan;
    double angle_tilt;
} replay_outputs_t;

void replay_init(const replay_inputs_t *inputs, replay_outputs_t *outputs);
void replay_step(const replay_inputs_t *inputs, replay_outputs_t *outputs);

#endif
