/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of the host's signals, one row per control cycle.
 */
#include "trace.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "files.h"
#include "number.h"

/** Columns besides those of the signals: the time before them; enabled, fault, lateness and computation after them. */
enum {
    COLUMNS_BEFORE = 1,
    COLUMNS_AFTER = 4,
    ROWS_AT_ONCE = 1024,  /* in the ring, if one thread adds and writes the rows */
    SHARED_SIZE = 4 << 20 /* bytes of the ring, if two threads share it: the disk may pause for seconds */
};

static size_t size_of_ring(size_t row_size, bool shared, uint64_t cycles)
{
    const size_t rows = shared ? SHARED_SIZE / row_size + ROWS_AT_ONCE : ROWS_AT_ONCE;
    return cycles < rows ? (size_t)cycles : rows;
}

bool epg_host_trace_start(epg_host_trace_t *trace, const epg_host_target_t *host, FILE *file, bool shared,
                          uint64_t cycles)
{
    *trace = (epg_host_trace_t){.host = host, .file = file, .shared = shared};
    if (file == NULL) {
        return true;
    }
    trace->columns = COLUMNS_BEFORE + host->signal_count + COLUMNS_AFTER;
    const size_t row_size = trace->columns * sizeof(double);
    trace->capacity = size_of_ring(row_size, shared, cycles);
    trace->rows = malloc(trace->capacity * row_size);
    if (trace->rows == NULL) {
        fputs("error: not enough memory for the trace\n", stderr);
        return false;
    }
    memset(trace->rows, 0, trace->capacity * row_size); /* maps all pages now, not in the control thread */
    fputs("time", file);
    for (size_t i = 0; i < host->signal_count; i++) {
        fprintf(file, ",%s", host->signals[i].name);
    }
    fputs(",enabled,fault,lateness,computation\n", file);
    return true;
}

static void write_row(const epg_host_trace_t *trace, const double *row)
{
    for (size_t column = 0; column < trace->columns; column++) {
        if (column > 0) {
            fputc(',', trace->file);
        }
        epg_host_write_number(trace->file, row[column]);
    }
    fputc('\n', trace->file);
}

/** Writes all rows of the ring. */
static void write_rows(epg_host_trace_t *trace)
{
    const size_t added = atomic_load(&trace->added);
    for (size_t next = atomic_load(&trace->written); next < added; next++) {
        write_row(trace, &trace->rows[next % trace->capacity * trace->columns]);
        atomic_store(&trace->written, next + 1);
    }
}

void epg_host_trace_write(epg_host_trace_t *trace)
{
    if (trace->file != NULL) {
        write_rows(trace);
        epg_host_files_flush(trace->file);
    }
}

void epg_host_trace_add(epg_host_trace_t *trace, uint64_t tick_ns, uint64_t lateness_ns, uint64_t computation_ns)
{
    if (trace->file == NULL) {
        return;
    }
    const size_t added = atomic_load(&trace->added);
    if (added - atomic_load(&trace->written) == trace->capacity) {
        if (trace->shared) {
            trace->dropped++;
            return;
        }
        write_rows(trace);
    }
    const epg_host_target_t *host = trace->host;
    const epg_control_t *control = host->target->control;
    double *row = &trace->rows[added % trace->capacity * trace->columns];
    *row++ = epg_host_seconds(tick_ns);
    for (size_t i = 0; i < host->signal_count; i++) {
        *row++ = *host->signals[i].value;
    }
    *row++ = control->enabled ? 1.0 : 0.0;
    *row++ = (double)control->fault;
    *row++ = epg_host_seconds(lateness_ns);
    *row = epg_host_seconds(computation_ns);
    atomic_store(&trace->added, added + 1);
}

void epg_host_trace_end(epg_host_trace_t *trace)
{
    if (trace->file == NULL) {
        return;
    }
    write_rows(trace);
    free(trace->rows);
    trace->rows = NULL;
    if (trace->dropped > 0) {
        fprintf(stderr, "warning: %" PRIu64 " rows of the trace are missing: the file was written too slowly\n",
                trace->dropped);
    }
}
