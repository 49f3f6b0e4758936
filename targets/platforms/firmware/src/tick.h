/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Ticks of a timer that EPG does not know, seen through a clock that may run at a slightly different speed.
 *
 * A program calls the cycle once per period of its timer.  This file finds, from the clock alone, when each tick was
 * due, how many ticks were missed, and whether the timer has the wrong period.
 *
 * A tick is due one period after the tick before it.  Interrupts delay a call, and never bring it forward.  A call that
 * comes before it was due therefore shows that the estimate was too late, and the tick was due at that call.  A call
 * that comes after it was due moves the estimate by a sixteenth of the difference.  So the estimate follows a timer
 * that is slower than the clock: with a difference of 100 ppm and a period of 1 ms, it lags by 1.6 us.
 */
#ifndef EPG_FIRMWARE_TICK_H
#define EPG_FIRMWARE_TICK_H

#include <stdbool.h>
#include <stdint.h>

/** Number of ticks after which the period is compared with the clock. */
#define EPG_FIRMWARE_WINDOW 128U
/** Largest difference between timer and clock: the window divided by this number, 1.6 percent. */
#define EPG_FIRMWARE_WINDOW_TOLERANCE 64U
/**
 * Calls in a row that miss ticks although no cycle is running, after which the timer is too slow.  By default, a
 * target latches "overrun" after 10, which would hide the cause.
 */
#define EPG_FIRMWARE_IDLE_ROW 8U

/** The state of a timer.  It is valid if all members but `period_ns` are zero. */
typedef struct epg_firmware_tick {
    uint64_t period_ns;
    uint64_t due_ns;       /**< time at which the newest tick was due */
    uint64_t ended_ns;     /**< time at which the newest cycle ended; written by the caller */
    uint64_t window_ns;    /**< time at which the first tick of the present window was due */
    uint32_t window_ticks; /**< ticks since then, with the missed ones */
    uint32_t window_idle;  /**< missed ticks among them before which no cycle was running */
    uint32_t idle_row;     /**< calls in a row that missed ticks before which no cycle was running */
    bool started;          /**< there was a tick */
    bool wrong_rate;       /**< the timer's period is not `period_ns` */
} epg_firmware_tick_t;

/**
 * Counts the tick whose call came at `now_ns`, and sets `due_ns`.  Returns the number of ticks that were missed before
 * it.  A call that is late by seven eighths of a period or more is the call of a later tick.
 */
static inline uint32_t epg_firmware_tick_pass(epg_firmware_tick_t *tick, uint64_t now_ns)
{
    if (!tick->started) {
        tick->started = true;
        tick->due_ns = now_ns;
        tick->window_ns = now_ns;
        return 0U;
    }
    const int64_t period_ns = (int64_t)tick->period_ns;
    int64_t late_ns = (int64_t)(now_ns - tick->due_ns) - period_ns;
    uint64_t ticks = 1U;
    bool idle = false;
    if (late_ns >= period_ns - period_ns / 8) {
        ticks += (uint64_t)((late_ns + period_ns / 8) / period_ns);
        late_ns -= (int64_t)(ticks - 1U) * period_ns;
        idle = tick->ended_ns - tick->due_ns < tick->period_ns;
        if (idle) {
            tick->window_idle += (uint32_t)(ticks - 1U);
        }
    }
    tick->due_ns = late_ns < 0 ? now_ns : now_ns - (uint64_t)(late_ns - late_ns / 16);
    tick->window_ticks += (uint32_t)ticks;
    if (tick->window_ticks >= EPG_FIRMWARE_WINDOW) {
        const int64_t expected_ns = (int64_t)tick->window_ticks * period_ns;
        const int64_t difference_ns = (int64_t)(tick->due_ns - tick->window_ns) - expected_ns;
        const int64_t tolerance_ns = expected_ns / (int64_t)EPG_FIRMWARE_WINDOW_TOLERANCE;
        /* A timer that is much slower looks like one with missed ticks.  Cycles that are too long miss ticks, too. */
        tick->wrong_rate = difference_ns < -tolerance_ns || difference_ns > tolerance_ns ||
                           tick->window_idle > tick->window_ticks / 4U;
        tick->window_ns = tick->due_ns;
        tick->window_ticks = 0U;
        tick->window_idle = 0U;
    }
    tick->idle_row = idle ? tick->idle_row + 1U : 0U;
    tick->wrong_rate = tick->wrong_rate || tick->idle_row >= EPG_FIRMWARE_IDLE_ROW;
    return (uint32_t)(ticks - 1U);
}

#endif
