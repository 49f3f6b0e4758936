/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick is a repeating timer of the SDK's alarm pool: on core 0 beside communication, or with ON_CORE_1 on core 1.
 */
#include "handwritten.h"
#include "pico/multicore.h"
#include "pico/stdlib.h"

static repeating_timer_t timer;
static uint32_t due_us;

static bool __attribute__((noinline)) on_tick(repeating_timer_t *repeating)
{
    (void)repeating;
    due_us += PERIOD_US;
    control_cycle(due_us, clocks_late(due_us, time_us_32()), 0); /* the alarm pool skips no tick */
    return true;
}

static void start(void)
{
    /* A negative time is the time between the starts of two calls. */
    control_start(0);
    alarm_pool_t *pool = alarm_pool_create_with_unused_hardware_alarm(4);
    due_us = time_us_32();
    if (!alarm_pool_add_repeating_timer_us(pool, -PERIOD_US, on_tick, NULL, &timer)) {
        panic("timer");
    }
}

#ifdef ON_CORE_1
static volatile bool started;

static void core1_main(void)
{
    start();
    started = true;
    for (;;) {
        __wfi();
    }
}
#endif

int main(void)
{
    stdio_init_all();
#ifdef ON_CORE_1
    multicore_launch_core1(core1_main);
    while (!started) {
        tight_loop_contents();
    }
#else
    start();
#endif
    for (;;) {
        communicate();
    }
}
