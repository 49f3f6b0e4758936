/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The axes of JIWY between their end stops.  Their speed is proportional to the duty; a small duty does not move them.
 */
#include "epg/mps2.h"
#include "epg/port.h"
#include "jiwy.h"
#include "program.h"

typedef struct axis {
    uint8_t pwm, a, b;       /* pins */
    double counts_per_cycle; /* at a duty of 1 */
    double last;             /* count of the upper end stop; the lower one is at 0 */
    double count;
} axis_t;

static axis_t pan = {.pwm = 4, .a = 5, .b = 6, .counts_per_cycle = 10.0, .last = 1112.0, .count = 100.0};
static axis_t tilt = {.pwm = 7, .a = 8, .b = 9, .counts_per_cycle = 4.0, .last = 221.0, .count = 60.0};

static uint32_t move(axis_t *axis)
{
    const double duty = mps2_duty(axis->pwm) * (mps2_duty(axis->a) - mps2_duty(axis->b));
    if (duty > 0.02 || duty < -0.02) {
        axis->count += duty * axis->counts_per_cycle;
    }
    axis->count = axis->count < 0.0 ? 0.0 : axis->count > axis->last ? axis->last : axis->count;
    return (uint32_t)axis->count;
}

volatile uint32_t axes_long_cycles;
volatile bool axes_fault;

uint32_t mps2_count(uint8_t pin_a)
{
    if (axes_fault && atomic_load(&jiwy_target.control->latch.requests[EPG_GATE_CONSOLE]) != 0U) {
        axes_fault = false;
        __asm volatile("udf #1");
    }
    if (pin_a == 0U && axes_long_cycles > 0U) {
        axes_long_cycles--;
        uint64_t last = epg_port_time_ns();
        const uint64_t end = last + 1500000U;
        while (last < end) {
            const uint64_t now = epg_port_time_ns();
            if (now < last) {
                return UINT32_MAX; /* the time of a cycle runs backwards; a wild count is a fault of JIWY's guard */
            }
            last = now;
        }
    }
    return move(pin_a == 0U ? &pan : &tilt);
}

static uint32_t driven(const axis_t *axis)
{
    return mps2_duty(axis->pwm) > 0.0 || mps2_duty(axis->a) > 0.0 || mps2_duty(axis->b) > 0.0;
}

uint32_t axes_driven(void)
{
    return driven(&pan) + driven(&tilt);
}
