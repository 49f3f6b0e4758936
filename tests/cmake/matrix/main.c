/* Firmware of the matrix: one step of a model, whose result is the exit status. */
#include "pan.h"

int main(void)
{
    pan_inputs_t inputs = {.setpoint = 1.0, .enable = 1.0, .limit = 3.0};
    pan_outputs_t outputs;
    pan_t *pan = pan_instance(0);
    pan_init(pan, &inputs, &outputs);
    pan_step(pan, &inputs, &outputs);
    return (outputs.duty > 0.0 && pan_finite(pan)) ? 0 : 1;
}
