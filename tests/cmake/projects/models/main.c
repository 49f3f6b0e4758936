/* Several models in one program do not disturb each other. */
#include <stdio.h>

#include "by_hand.h"
#include "first.h"
#include "relbot_plant.h"
#include "second.h"
#include "wheels.h"

int main(void)
{
    first_inputs_t u1 = {.position_pan = 0.5};
    second_inputs_t u2 = {.position_pan = 0.5};
    first_outputs_t y1;
    second_outputs_t y2;
    first_init(first_instance(0), &u1, &y1);
    second_init(second_instance(0), &u2, &y2);
    for (int i = 0; i < 7000; i++) { /* no movement: homing stops with an error */
        first_step(first_instance(0), &u1, &y1);
    }
    printf("first %.17g second %.17g\n", y1.pwm_pan, y2.pwm_pan);

    wheels_t *a = wheels_instance(0), *b = wheels_instance(1);
    wheels_inputs_t ua = {.SetPosLeft = 0.01}, ub = {.SetPosLeft = 0.01};
    wheels_outputs_t ya, yb, yc;
    wheels_init(a, &ua, &ya);
    wheels_init(b, &ub, &yb);
    for (int i = 0; i < 20000; i++) { /* beyond the experiment's finish time */
        wheels_step(a, &ua, &ya);
    }
    ua.SetPosLeft = -0.01;
    wheels_step(a, &ua, &yc);
    wheels_step(b, &ub, &yb);
    printf("instances %d frozen %d third %d\n", ya.SteerLeft != yb.SteerLeft, yc.SteerLeft == ya.SteerLeft,
           wheels_instance(2) != NULL);

    wheels_init(a, &ub, &ya);
    wheels_step(a, &ub, &ya);
    printf("again %d finite %d stopped %d\n", ya.SteerLeft == yb.SteerLeft, wheels_finite(a), wheels_stopped(a));

    double before = first_get_parameter(first_instance(0), FIRST_PAN_PID_KP);
    first_set_parameter(first_instance(0), FIRST_PAN_PID_KP, 5.0);
    printf("parameters %g %g %g\n", before, first_get_parameter(first_instance(0), FIRST_PAN_PID_KP),
           second_get_parameter(second_instance(0), SECOND_PAN_PID_KP));

    relbot_plant_inputs_t up = {0};
    relbot_plant_outputs_t yp;
    relbot_plant_init(relbot_plant_instance(0), &up, &yp);
    by_hand_inputs_t uh = {.go = 1.0, .setpoint = 3.0, .angle = 1.0};
    by_hand_outputs_t yh;
    by_hand_init(by_hand_instance(0), &uh, &yh);
    printf("by hand %g step %g %g\n", yh.duty, FIRST_STEP_SIZE, WHEELS_STEP_SIZE);
    return 0;
}
