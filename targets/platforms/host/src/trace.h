/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of the host's signals, one row per control cycle.
 *
 * Rows are collected in a buffer that is allocated before the run.  In simulated time the buffer is written to the file
 * when it is full.  In real time it has room for the whole run, so the control thread never writes to the file.
 */
#ifndef EPG_HOST_TRACE_H
#define EPG_HOST_TRACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "epg/host.h"

typedef struct epg_host_trace {
    const epg_host_target_t *host;
    FILE *file;   /**< NULL: nothing is recorded */
    double *rows; /**< `capacity` rows of `columns` values; on the heap */
    size_t columns;
    size_t capacity;
    size_t count;
} epg_host_trace_t;

/**
 * Prepares the recording of up to `cycles` rows, all of them in memory if `realtime` is true.  Returns false, with a
 * message, if there is not enough memory.
 */
bool epg_host_trace_start(epg_host_trace_t *trace, const epg_host_target_t *host, FILE *file, bool realtime,
                          uint64_t cycles);

/** Records the present values of all signals at the end of a cycle, whose tick was at `tick_ns` since time 0. */
void epg_host_trace_add(epg_host_trace_t *trace, uint64_t tick_ns, uint64_t lateness_ns, uint64_t computation_ns);

/** Writes the remaining rows and frees the buffer.  The file stays open. */
void epg_host_trace_end(epg_host_trace_t *trace);

#endif
