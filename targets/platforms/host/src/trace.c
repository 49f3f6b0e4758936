/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of the host's signals, one row per control cycle.
 */
#include "trace.h"

#include <stdlib.h>
#include <string.h>

#include "number.h"

/** Columns besides those of the signals: the time before them; enabled, fault, lateness and computation after them. */
enum { COLUMNS_BEFORE = 1, COLUMNS_AFTER = 4, ROWS_AT_ONCE = 1024 };

bool epg_host_trace_start(epg_host_trace_t *trace, const epg_host_target_t *host, FILE *file, bool realtime,
                          uint64_t cycles)
{
    *trace = (epg_host_trace_t){.host = host, .file = file};
    if (file == NULL) {
        return true;
    }
    trace->columns = COLUMNS_BEFORE + host->signal_count + COLUMNS_AFTER;
    const uint64_t rows = realtime || cycles < ROWS_AT_ONCE ? cycles : ROWS_AT_ONCE;
    const uint64_t row_size = trace->columns * sizeof(double);
    if (rows <= SIZE_MAX / row_size) {
        trace->rows = malloc((size_t)(rows * row_size));
    }
    if (trace->rows == NULL) {
        fprintf(stderr,
                "error: not enough memory for a trace of %.0f MB\n"
                "hint: in real time the whole trace is kept in memory; choose a shorter --duration\n",
                (double)rows * (double)row_size / 1e6);
        return false;
    }
    trace->capacity = (size_t)rows;
    memset(trace->rows, 0, (size_t)(rows * row_size)); /* maps all pages now, not in the control thread */
    fputs("time", file);
    for (size_t i = 0; i < host->signal_count; i++) {
        fprintf(file, ",%s", host->signals[i].name);
    }
    fputs(",enabled,fault,lateness,computation\n", file);
    return true;
}

static void write_rows(epg_host_trace_t *trace)
{
    for (size_t row = 0; row < trace->count; row++) {
        for (size_t column = 0; column < trace->columns; column++) {
            if (column > 0) {
                fputc(',', trace->file);
            }
            epg_host_write_number(trace->file, trace->rows[row * trace->columns + column]);
        }
        fputc('\n', trace->file);
    }
    trace->count = 0;
}

void epg_host_trace_add(epg_host_trace_t *trace, uint64_t tick_ns, uint64_t lateness_ns, uint64_t computation_ns)
{
    if (trace->file == NULL) {
        return;
    }
    if (trace->count == trace->capacity) {
        write_rows(trace); /* does not happen in real time: there is a row for each cycle */
    }
    const epg_host_target_t *host = trace->host;
    const epg_control_t *control = host->target->control;
    double *row = &trace->rows[trace->count++ * trace->columns];
    *row++ = epg_host_seconds(tick_ns);
    for (size_t i = 0; i < host->signal_count; i++) {
        *row++ = *host->signals[i].value;
    }
    *row++ = control->enabled ? 1.0 : 0.0;
    *row++ = (double)control->fault;
    *row++ = epg_host_seconds(lateness_ns);
    *row = epg_host_seconds(computation_ns);
}

void epg_host_trace_end(epg_host_trace_t *trace)
{
    if (trace->file != NULL) {
        write_rows(trace);
        free(trace->rows);
        trace->rows = NULL;
    }
}
