/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick is the wrap of a PWM slice, on core 1; communication is on core 0.
 */
#include "handwritten.h"
#include "pico/multicore.h"
#include "pico/stdlib.h"
#include "wrap.h"

static void core1_main(void)
{
    wrap_start();
    for (;;) {
        __wfi();
    }
}

int main(void)
{
    stdio_init_all();
    multicore_launch_core1(core1_main);
    for (;;) {
        communicate();
    }
}
