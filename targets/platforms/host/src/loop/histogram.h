/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The distribution of measured times, in memory of fixed size.
 *
 * A histogram counts the values that fall into each bucket.  Each octave, the range from one power of two to the next,
 * is divided into 32 equal buckets.  A quantile is therefore accurate to 1/32 of its value, over the whole range of 64
 * bits (the layout of HdrHistogram).  Adding a value allocates no memory.
 */
#ifndef EPG_HOST_HISTOGRAM_H
#define EPG_HOST_HISTOGRAM_H

#include <stddef.h>
#include <stdint.h>

enum { EPG_HOST_BUCKETS_PER_OCTAVE = 32, EPG_HOST_BUCKETS = 60 * EPG_HOST_BUCKETS_PER_OCTAVE };

/** Zero-initialised memory is an empty histogram. */
typedef struct epg_host_histogram {
    uint64_t count;
    uint64_t min; /**< ns; 0 when empty */
    uint64_t max; /**< ns */
    double total; /**< ns */
    uint64_t buckets[EPG_HOST_BUCKETS];
} epg_host_histogram_t;

void epg_host_histogram_add(epg_host_histogram_t *histogram, uint64_t value);

/** Mean in nanoseconds; 0 when empty. */
double epg_host_histogram_mean(const epg_host_histogram_t *histogram);

/** The value that a `share` (0 ... 1) of all values does not exceed, rounded up to the end of its bucket; ns. */
uint64_t epg_host_histogram_quantile(const epg_host_histogram_t *histogram, double share);

/** Number of values in buckets that begin below `limit` and at or above `from`. */
uint64_t epg_host_histogram_between(const epg_host_histogram_t *histogram, uint64_t from, uint64_t limit);

#endif
