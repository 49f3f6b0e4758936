/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Limits of conversions: the key `limits: [low, high]` of a component or a wire.
 */
#ifndef EPG_LIMIT_H
#define EPG_LIMIT_H

#include "epg/control.h"

/** Returns the number in [low, high] that is nearest to `value`. */
static inline double epg_clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

/** As epg_clamp(), and counts a value outside [low, high] in the statistics of `control`.  Control side. */
static inline double epg_limit(epg_control_t *control, double value, double low, double high)
{
    if (value < low) {
        epg_control_count_clamped(control);
        return low;
    }
    if (value > high) {
        epg_control_count_clamped(control);
        return high;
    }
    return value;
}

#endif
