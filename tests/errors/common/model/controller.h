/* A small controller for the tests of messages. */
#ifndef CONTROLLER_H
#define CONTROLLER_H

typedef struct {
    double angle;
    double go;
    double setpoint;
} controller_inputs_t;

typedef struct {
    double duty;
    double log;
    double reset;
} controller_outputs_t;

void controller_init(const controller_inputs_t *inputs, controller_outputs_t *outputs);
void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs);

#endif
