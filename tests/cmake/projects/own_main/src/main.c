/* The user's own main(): two targets, of which one runs for a short time. */
#include <stdio.h>

#include "left.h"
#include "right.h"

/* Waits until the cycle with this number has run. */
static void run_until(uint32_t cycles)
{
    epg_status_t status = {0};
    while (status.statistics.cycles < cycles) {
        (void)left_status(&status);
    }
}

int main(void)
{
    if (!left_start()) {
        return 1;
    }
    run_until(200);
    left_enable(true);
    (void)left_set_setpoint(0.25);
    left_values_t values;
    (void)left_get(&values); /* requests them */
    run_until(400);
    epg_status_t status;
    if (!left_status(&status) || !left_get(&values)) {
        return 2;
    }
    if (values.inputs.setpoint < 0.25 || values.inputs.setpoint > 0.25) {
        return 4;
    }
    left_stop();
    printf("cycles %u enabled %d\n", (unsigned)status.statistics.cycles, status.enabled);
    return right_status(&status) ? 3 : 0; /* right was never started */
}
