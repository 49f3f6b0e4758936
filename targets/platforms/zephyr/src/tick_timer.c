/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick of emulated boards (native_sim, QEMU): a k_timer.  On a real board it would be late whenever other code
 * delays the interrupt of the system clock.
 */
#include <zephyr/kernel.h>

#include "epg/port.h"
#include "parts.h"

static struct {
    uint64_t origin_ns; /* time from which the periods are counted */
    uint64_t period_ns;
} state;

static void on_expiry(struct k_timer *timer)
{
    ARG_UNUSED(timer);
    epg_zephyr_control_tick();
}

static K_TIMER_DEFINE(timer, on_expiry, NULL);

epg_zephyr_error_t epg_zephyr_tick_start(const epg_zephyr_tick_t *tick, uint64_t period_ns)
{
    ARG_UNUSED(tick);
    const uint64_t ticks = k_ns_to_ticks_floor64(period_ns);
    if (ticks == 0U || k_ticks_to_ns_floor64(ticks) != period_ns) {
        return EPG_ZEPHYR_ERROR_TICK; /* the period is not a whole number of the system clock's ticks */
    }
    /* Begin at a tick of the system clock: the timer then expires at whole periods after it. */
    const int64_t first = k_uptime_ticks() + 1;
    state.period_ns = period_ns;
    state.origin_ns = k_ticks_to_ns_floor64((uint64_t)first);
    k_timer_start(&timer, K_TIMEOUT_ABS_TICKS(first + (int64_t)ticks), K_TICKS((k_ticks_t)ticks));
    return EPG_ZEPHYR_OK;
}

void epg_zephyr_tick_stop(void)
{
    k_timer_stop(&timer);
}

uint64_t epg_zephyr_tick_newest_ns(uint64_t *now_ns)
{
    *now_ns = epg_port_time_ns();
    if (*now_ns < state.origin_ns) {
        return state.origin_ns;
    }
    return *now_ns - (*now_ns - state.origin_ns) % state.period_ns;
}
