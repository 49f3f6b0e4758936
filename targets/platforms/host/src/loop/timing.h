/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Measurements of control cycles: lateness, intervals and computation times.
 */
#ifndef EPG_HOST_TIMING_H
#define EPG_HOST_TIMING_H

#include <stdint.h>

#include "histogram.h"

/**
 * All times are in nanoseconds.  A deviation is the interval between the starts of two cycles minus the interval
 * between their ticks.  Zero-initialised memory is a valid start.
 */
typedef struct epg_host_timing {
    epg_host_histogram_t lateness;    /**< time from the tick to the start of the cycle */
    epg_host_histogram_t computation; /**< duration of epg_control_cycle(), by the monotonic clock in both modes */
    int64_t deviation_min;
    int64_t deviation_max;
    double deviation_squares; /**< sum of the squares of all deviations, ns^2 */
    uint64_t lateness_last;   /**< lateness of the previous cycle */
} epg_host_timing_t;

/** Adds the measurements of a cycle. */
void epg_host_timing_add(epg_host_timing_t *timing, uint64_t lateness_ns, uint64_t computation_ns);

/** Root mean square of all deviations, in nanoseconds; 0 before the second cycle. */
double epg_host_timing_deviation_rms(const epg_host_timing_t *timing);

#endif
