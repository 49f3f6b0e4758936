#include "pid.h"

const int shared = 7; /* a global, to meet that of another model */

static double limited(double value, double limit)
{
    return value > limit ? limit : (value < -limit ? -limit : value);
}

void pid_init(pid_t *pid, const pid_inputs_t *in, pid_outputs_t *out)
{
    pid->sum = 0.0;
    out->duty = limited(pid->kp * (in->setpoint - in->position), in->limit);
    out->steps = pid->steps;
    out->saturated = false;
}

void pid_step(pid_t *pid, const pid_inputs_t *in, pid_outputs_t *out)
{
    const double error = in->setpoint - in->position;

    pid->sum += pid->integral.rate * error;
    pid->steps++;
    out->duty = in->enable ? limited(pid->kp * error + pid->sum, in->limit) : 0.0;
    out->saturated = out->duty == in->limit;
    out->steps = pid->steps;
    pid->stop = pid->steps >= 1000;
}

void pid_end(pid_t *pid, const pid_inputs_t *in, pid_outputs_t *out)
{
    (void)pid;
    (void)in;
    out->duty = 0.0;
}

bool pid_stopped(const pid_t *pid)
{
    return pid->stop;
}

bool pid_finite(const pid_t *pid)
{
    return pid->sum - pid->sum == 0.0;
}
