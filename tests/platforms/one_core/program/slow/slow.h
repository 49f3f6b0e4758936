/* SPDX-License-Identifier: Apache-2.0 */
typedef struct {
    double angle;
} slow_inputs_t;

typedef struct {
    double duty;
} slow_outputs_t;

void slow_init(const slow_inputs_t *inputs, slow_outputs_t *outputs);
void slow_step(const slow_inputs_t *inputs, slow_outputs_t *outputs);
