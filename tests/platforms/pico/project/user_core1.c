/*
 * A program that uses core 1 itself: it counts there, and starts and stops its target when a test orders it.  Core 1's
 * program is in flash.  It has its own stack or, as in most programs, the default one.
 */
#include <stdbool.h>
#include <stdint.h>

#include "epg/pico.h"
#include "pico.h"
#include "pico/multicore.h"

#include "bench.h"

enum { ORDER_NONE, ORDER_START, ORDER_STOP, ORDER_LAUNCH, ORDER_LAUNCH_WITH_STACK, ORDER_RESET };

volatile uint32_t order;
volatile int32_t answer = -1;
volatile uint32_t error;
volatile uint32_t turns; /* of core 1 */
epg_status_t status;

static uint32_t stack[256];

static void count(void)
{
    for (;;) {
        turns++;
    }
}

int main(void)
{
    for (;;) {
        const uint32_t now = order;
        if (now != ORDER_NONE) {
            order = ORDER_NONE; /* only then: the test may have written a new order meanwhile */
        }
        switch (now) {
        case ORDER_START:
            answer = bench_start() ? 1 : 0;
            break;
        case ORDER_STOP:
            answer = bench_stop() ? 1 : 0;
            break;
        case ORDER_LAUNCH:
            multicore_launch_core1(count);
            answer = 2;
            break;
        case ORDER_LAUNCH_WITH_STACK:
            multicore_launch_core1_with_stack(count, stack, sizeof stack);
            answer = 2;
            break;
        case ORDER_RESET:
            multicore_reset_core1();
            answer = 2;
            break;
        default:
            break;
        }
        epg_pico_status_t port;
        epg_pico_status(&port);
        error = (uint32_t)port.error;
        (void)bench_status(&status);
    }
}
