/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of the host's signals, one row per control cycle.
 *
 * Rows are collected in a ring that is allocated before the run.  In simulated time the ring is written to the file when
 * it is full.  In real time another thread writes it (epg_host_trace_write()), and the control thread never waits for
 * the file: a row that finds no room is dropped and counted.
 */
#ifndef EPG_HOST_TRACE_H
#define EPG_HOST_TRACE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "epg/host.h"

typedef struct epg_host_trace {
    const epg_host_target_t *host;
    FILE *file;   /**< NULL: nothing is recorded */
    bool shared;  /**< another thread writes the rows */
    double *rows; /**< `capacity` rows of `columns` values; on the heap */
    size_t columns;
    size_t capacity;
    atomic_size_t added;   /**< rows since the start; only epg_host_trace_add() changes it */
    atomic_size_t written; /**< rows that were taken out of the ring; only epg_host_trace_write() changes it */
    uint64_t dropped;      /**< rows that found no room in the ring */
} epg_host_trace_t;

/**
 * Prepares the recording of up to `cycles` rows.  If `shared` is true, another thread than that of
 * epg_host_trace_add() calls epg_host_trace_write().  Returns false, with a message, if there is not enough memory.
 */
bool epg_host_trace_start(epg_host_trace_t *trace, const epg_host_target_t *host, FILE *file, bool shared,
                          uint64_t cycles);

/** Records the present values of all signals at the end of a cycle, whose tick was at `tick_ns` since time 0. */
void epg_host_trace_add(epg_host_trace_t *trace, uint64_t tick_ns, uint64_t lateness_ns, uint64_t computation_ns);

/** Writes the rows of the ring to the file, so that they are kept if the program is killed. */
void epg_host_trace_write(epg_host_trace_t *trace);

/** Writes the remaining rows, reports dropped ones on stderr, and frees the ring.  The file stays open. */
void epg_host_trace_end(epg_host_trace_t *trace);

#endif
