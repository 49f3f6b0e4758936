/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of the host's signals, one row per control cycle.
 *
 * Rows are collected in memory that is allocated beforehand.  In simulated time a full buffer is written to the
 * file at once; in real time the buffer holds the whole run, and the control thread never touches the file.
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

/** Prepares recording of up to `cycles` rows, all of them in memory if `realtime`.  False, with a message, if there is not memory enough. */
bool epg_host_trace_start(epg_host_trace_t *trace, const epg_host_target_t *host, FILE *file, bool realtime,
                          uint64_t cycles);

/**
 * Records the present values of all signals, at the end of the cycle of `tick_ns` (since time 0).  Runs on the
 * control side.
 */
void epg_host_trace_add(epg_host_trace_t *trace, uint64_t tick_ns, uint64_t lateness_ns, uint64_t computation_ns);

/** Writes what is still in memory and frees it.  The file stays open. */
void epg_host_trace_end(epg_host_trace_t *trace);

#endif
