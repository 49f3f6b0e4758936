/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick of chips other than RP2040 and RP2350: the top value of a counter.  The counter's hardware starts again by
 * itself at its top value, so a tick can be late but is never lost.
 */
#include <zephyr/drivers/counter.h>
#include <zephyr/kernel.h>

#include "epg/port.h"
#include "parts.h"

#define NS_PER_S 1000000000U

static struct {
    const struct device *counter;
    uint64_t ns_per_count; /* times 2^24 */
    uint32_t top;
    bool counts_up;
} state;

static void on_top(const struct device *counter, void *user)
{
    ARG_UNUSED(counter);
    ARG_UNUSED(user);
    epg_zephyr_control_tick();
}

epg_zephyr_error_t epg_zephyr_tick_start(const epg_zephyr_tick_t *tick, uint64_t period_ns)
{
    ARG_UNUSED(period_ns);
    const struct counter_top_cfg top = {.ticks = tick->top, .callback = on_top};
    if (tick->device == NULL || !epg_zephyr_ready(tick->device)) {
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    if (tick->prescaler == 0U ||
        !epg_zephyr_check_clock("the timer of the tick, after its prescaler,", tick->clock / tick->prescaler,
                                counter_get_frequency(tick->device))) {
        return EPG_ZEPHYR_ERROR_TICK;
    }
    /* In two steps: the product of 2^24 and the nanoseconds of a large prescaler needs more than 64 bits. */
    const uint64_t prescaled_ns = (uint64_t)tick->prescaler * NS_PER_S;
    state.ns_per_count = ((prescaled_ns / tick->clock) << 24) + ((prescaled_ns % tick->clock) << 24) / tick->clock;
    state.counter = tick->device;
    state.top = tick->top;
    state.counts_up = counter_is_counting_up(tick->device);
    if (counter_set_top_value(tick->device, &top) < 0 || counter_start(tick->device) < 0) {
        epg_zephyr_tick_stop();
        return EPG_ZEPHYR_ERROR_DEVICE;
    }
    return EPG_ZEPHYR_OK;
}

void epg_zephyr_tick_stop(void)
{
    if (state.counter != NULL) {
        (void)counter_stop(state.counter);
    }
}

uint64_t epg_zephyr_tick_newest_ns(uint64_t *now_ns)
{
    uint32_t count = 0;
    const unsigned int key = irq_lock();
    *now_ns = epg_port_time_ns();
    (void)counter_get_value(state.counter, &count);
    irq_unlock(key);
    if (!state.counts_up) { /* it counts from top down to 0 */
        count = state.top - count;
    }
    return *now_ns - (count * state.ns_per_count >> 24);
}
