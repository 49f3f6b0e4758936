/* SPDX-License-Identifier: Apache-2.0 */
#include <stdint.h>

int16_t angle; /* counts of the encoder */
double duty;
static double target; /* counts */

/* Every 10 ms: the target moves by one count, up to 50. */
void trajectory(void)
{
    if (target < 50.0) {
        target += 1.0;
    }
}

/* Every 1 ms. */
void position_loop(void)
{
    duty = 0.01 * (target - (double)angle);
}
