#include "law.h"

#include <math.h>

static double limit(double value)
{
    return fmax(-1.0, fmin(1.0, value));
}

double law_step(law_t *law, double error, double kp, double ki, double step)
{
    double sum = 0.0;
    double duty;

    law->errors[law->next] = error;
    law->next = (law->next + 1) % law->size;
    for (int i = 0; i < law->size; i++) {
        sum += law->errors[i];
    }
    law->rate = ki * sum / law->size;
    law->integral += law->rate * step;
    duty = kp * sum / law->size + law->integral;
    law->saturated = fabs(duty) > 1.0;
    return limit(duty);
}
