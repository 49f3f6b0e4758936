/* The same controller, twice from an archive, and once from a folder. */
#include <stdio.h>

#include "axes.h"
#include "pan.h"
#include "tilt.h"

int main(void)
{
    const pan_inputs_t u = {.plant_setpoint = 0.5, .plant_position = 0.1, .enable = 1.0};
    const tilt_inputs_t v = {.plant_setpoint = 0.5, .plant_position = 0.1, .enable = 1.0};
    const axes_inputs_t w = {.setpoint_1 = 1.0, .gain = 0.5, .mask = 1.0};
    pan_outputs_t y[2];
    tilt_outputs_t z;
    axes_outputs_t a;

    for (unsigned i = 0; i < PAN_INSTANCES; i++) {
        pan_init(pan_instance(i), &u, &y[i]);
    }
    tilt_init(tilt_instance(0), &v, &z);
    axes_init(axes_instance(0), &w, &a);
    for (int k = 0; k < 100; k++) {
        pan_step(pan_instance(0), &u, &y[0]);
        tilt_step(tilt_instance(0), &v, &z);
        axes_step(axes_instance(0), &w, &a);
    }
    printf("%d %d %g %g\n", y[0].duty == z.duty, y[1].duty == z.duty, z.steps, a.count);
    printf("%d %d %d\n", pan_finite(pan_instance(1)), tilt_finite(tilt_instance(0)), axes_finite(axes_instance(0)));
    return 0;
}
