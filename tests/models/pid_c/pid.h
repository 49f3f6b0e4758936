/* A hand-written controller with an instance struct, for the tests. */
#ifndef PID_H
#define PID_H

#include <stdbool.h>

typedef struct pid {
    double kp;
    struct {
        double rate;
    } integral;
    double sum;
    int steps;
    bool stop;
} pid_t;

typedef struct {
    double setpoint;
    double position;
    bool enable;
    int limit;
} pid_inputs_t;

typedef struct {
    double duty;
    int steps;
    bool saturated;
} pid_outputs_t;

void pid_init(pid_t *pid, const pid_inputs_t *in, pid_outputs_t *out);
void pid_step(pid_t *pid, const pid_inputs_t *in, pid_outputs_t *out);
void pid_end(pid_t *pid, const pid_inputs_t *in, pid_outputs_t *out);
bool pid_stopped(const pid_t *pid);
bool pid_finite(const pid_t *pid);

#endif
