/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Limits of conversions: `limits: [low, high]` on a component or a wire.
 */
#ifndef EPG_LIMIT_H
#define EPG_LIMIT_H

#include "epg/control.h"

/** `value` within [low, high]. */
static inline double epg_clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

/** `value` within [low, high]; counts it in the statistics of `control` if it was outside. */
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
