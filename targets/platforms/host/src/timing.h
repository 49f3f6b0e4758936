/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * When control cycles began and how long they took.
 */
#ifndef EPG_HOST_TIMING_H
#define EPG_HOST_TIMING_H

#include <stdint.h>

#include "histogram.h"

/** Zero-initialised memory is a valid start. */
typedef struct epg_host_timing {
    epg_host_histogram_t lateness;    /**< from tick to start of a cycle */
    epg_host_histogram_t computation; /**< of epg_control_cycle(), by the monotonic clock in both modes */
    int64_t deviation_min;            /**< of the interval between two cycles from the one between their ticks, ns */
    int64_t deviation_max;
    double deviation_squares; /**< sum of squares, ns^2 */
    uint64_t lateness_last;
} epg_host_timing_t;

/** Adds one cycle. */
void epg_host_timing_add(epg_host_timing_t *timing, uint64_t lateness_ns, uint64_t computation_ns);

/** Root mean square of the intervals' deviation, in nanoseconds; 0 before the second cycle. */
double epg_host_timing_deviation_rms(const epg_host_timing_t *timing);

#endif
