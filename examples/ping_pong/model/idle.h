/**
 * @file
 * A controller that only counts its steps: ping-pong measures communication, with a control loop beside it.
 */
#ifndef IDLE_H
#define IDLE_H

typedef struct {
    double steps;
} idle_outputs_t;

void idle_init(idle_outputs_t *outputs);
void idle_step(idle_outputs_t *outputs);

#endif
