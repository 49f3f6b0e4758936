/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Which tick a timer's interrupt is for, and how many were missed before it.
 */
#ifndef EPG_TICKS_H
#define EPG_TICKS_H

#include <stdint.h>

typedef struct epg_mcu_ticks {
    uint64_t due_ns; /**< of the newest tick */
    int64_t period_ns;
} epg_mcu_ticks_t;

/**
 * Ticks that have passed since `due_ns`, none of which is late; the rest is the present one's.  0: the present one was
 * counted together with the one before.  Times of the clock are off by up to `tolerance_ns`.
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
