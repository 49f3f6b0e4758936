/* Returns 0 if the second run of each model equals its first run, and no model disturbs another one. */
#include <stdio.h>
#include <string.h>

#include "twin.h"
#include "wheels.h"
#include "worn.h"

enum { STEPS = 50 };

static void run_worn(worn_t *self, double *outputs)
{
    worn_inputs_t in = {0};
    worn_outputs_t out;

    worn_init(self, &in, &out);
    for (int k = 0; k < STEPS; k++) {
        worn_step(self, &in, &out);
        outputs[k] = out.worn;
    }
}

static void run_wheels(wheels_t *self, double *outputs)
{
    wheels_inputs_t in = {.SetPosLeft = 0.01, .SetPosRight = 0.02};
    wheels_outputs_t out;

    wheels_init(self, &in, &out);
    for (int k = 0; k < STEPS; k++) {
        wheels_step(self, &in, &out);
        outputs[k] = out.SteerLeft + out.SteerRight;
    }
}

int main(void)
{
    static double first[STEPS], second[STEPS], of_twin[STEPS];
    twin_t *twin = twin_instance(0);
    twin_inputs_t in = {0};
    twin_outputs_t out;
    int different;

    twin_init(twin, &in, &out);
    run_worn(worn_instance(0), first);
    for (int k = 0; k < STEPS; k++) {
        twin_step(twin, &in, &out);
        of_twin[k] = out.worn;
        if (k == STEPS / 2) {
            run_worn(worn_instance(0), second);
        }
    }
    different = memcmp(first, second, sizeof first) != 0 || memcmp(first, of_twin, sizeof first) != 0;
    printf("%.17g %.17g\n", first[0], first[STEPS - 1]);
    run_wheels(wheels_instance(0), first);
    run_wheels(wheels_instance(0), second);
    printf("%.17g %.17g\n", first[0], first[1]);
    return different || memcmp(first, second, sizeof first) != 0;
}
