/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The distribution of measured times, in memory of fixed size.
 */
#include "histogram.h"

enum { SUB = EPG_HOST_BUCKETS_PER_OCTAVE };

/**
 * The bucket of a value.  Values below 2 * SUB have one bucket each.  Above, the leading bit selects the octave, and
 * the next five bits select the bucket in it.
 */
static size_t bucket_of(uint64_t value)
{
    unsigned shift = 0;
    while (value >> shift >= 2U * SUB) {
        shift++;
    }
    return (size_t)shift * SUB + (size_t)(value >> shift);
}

/** The smallest value that belongs to bucket `index`. */
static uint64_t bucket_start(size_t index)
{
    if (index < 2U * SUB) {
        return index;
    }
    const size_t shift = index / SUB - 1;
    return (uint64_t)(index - shift * SUB) << shift;
}

void epg_host_histogram_add(epg_host_histogram_t *histogram, uint64_t value)
{
    if (histogram->count == 0 || value < histogram->min) {
        histogram->min = value;
    }
    if (value > histogram->max) {
        histogram->max = value;
    }
    histogram->count++;
    histogram->total += (double)value;
    histogram->buckets[bucket_of(value)]++;
}

double epg_host_histogram_mean(const epg_host_histogram_t *histogram)
{
    return histogram->count == 0 ? 0.0 : histogram->total / (double)histogram->count;
}

uint64_t epg_host_histogram_quantile(const epg_host_histogram_t *histogram, double share)
{
    uint64_t below = 0;
    for (size_t i = 0; i < EPG_HOST_BUCKETS && histogram->count > 0; i++) {
        below += histogram->buckets[i];
        if ((double)below >= share * (double)histogram->count) {
            const uint64_t last = i + 1 < EPG_HOST_BUCKETS ? bucket_start(i + 1) - 1 : UINT64_MAX;
            return last < histogram->max ? last : histogram->max;
        }
    }
    return histogram->max;
}

uint64_t epg_host_histogram_between(const epg_host_histogram_t *histogram, uint64_t from, uint64_t limit)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < EPG_HOST_BUCKETS && bucket_start(i) < limit; i++) {
        sum += bucket_start(i) >= from ? histogram->buckets[i] : 0;
    }
    return sum;
}
