/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Measurements of control cycles: lateness, intervals and computation times.
 */
#include "timing.h"

#include <math.h>

void epg_host_timing_add(epg_host_timing_t *timing, uint64_t lateness_ns, uint64_t computation_ns)
{
    if (timing->lateness.count > 0) {
        /* (start - previous start) - (tick - previous tick); ticks that were skipped have no influence */
        const int64_t deviation = (int64_t)(lateness_ns - timing->lateness_last);
        timing->deviation_min = deviation < timing->deviation_min ? deviation : timing->deviation_min;
        timing->deviation_max = deviation > timing->deviation_max ? deviation : timing->deviation_max;
        timing->deviation_squares += (double)deviation * (double)deviation;
    }
    timing->lateness_last = lateness_ns;
    epg_host_histogram_add(&timing->lateness, lateness_ns);
    epg_host_histogram_add(&timing->computation, computation_ns);
}

double epg_host_timing_deviation_rms(const epg_host_timing_t *timing)
{
    const uint64_t cycles = timing->lateness.count;
    return cycles < 2 ? 0.0 : sqrt(timing->deviation_squares / (double)(cycles - 1));
}
