/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A controller whose outputs are a constant duty and sine waves of nine frequencies.
 */
#ifndef WAVES_H
#define WAVES_H

typedef struct {
    double in_0, in_1, in_2, in_3, in_4, in_5, in_6, in_7, in_8, in_9;
} waves_inputs_t;

typedef struct {
    double duty, wave_1, wave_2, wave_3, wave_4, wave_5, wave_6, wave_7, wave_8, wave_9;
} waves_outputs_t;

void waves_init(const waves_inputs_t *inputs, waves_outputs_t *outputs);
void waves_step(const waves_inputs_t *inputs, waves_outputs_t *outputs);

#endif
