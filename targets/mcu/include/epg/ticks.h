/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The number of ticks that have passed since the last control cycle.
 *
 * A timer that repeats by itself raises one interrupt per period.  If an interrupt is handled more than a period
 * late, two or more ticks have become one interrupt.  The clock shows how many: each whole period since the last tick
 * is a tick.
 */
#ifndef EPG_TICKS_H
#define EPG_TICKS_H

#include <stdint.h>

typedef struct epg_mcu_ticks {
    uint64_t due_ns;   /**< time at which the newest tick was due */
    int64_t period_ns; /**< control period */
} epg_mcu_ticks_t;

/**
 * Returns the number of ticks between `ticks->due_ns` and `now_ns`, and moves `ticks->due_ns` to the newest of them.
 * 1 is the normal result.  A result n > 1 means that n - 1 ticks were missed.  0 means that the tick of this interrupt
 * was already counted in the cycle before; no cycle must run.
 *
 * The clock may differ from the true time by up to `tolerance_ns`, which must be much smaller than a period.
 */
static inline uint32_t epg_mcu_ticks_pass(epg_mcu_ticks_t *ticks, uint64_t now_ns, int64_t tolerance_ns)
{
    const int64_t late = (int64_t)(now_ns - ticks->due_ns) - ticks->period_ns;
    uint32_t passed = 1U;
    if (late < -tolerance_ns) {
        return 0U;
    }
    if (late >= ticks->period_ns - tolerance_ns) {
        passed += (uint32_t)((late + tolerance_ns) / ticks->period_ns);
    }
    ticks->due_ns += passed * (uint64_t)ticks->period_ns;
    return passed;
}

#endif
