/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The records are kept in memory while the control loop runs, and written to the file when the program ends.
 */
#include "instants.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "epg/port.h"

enum { MOST = 100000 };

static struct {
    double value;
    uint64_t arrival_ns;
    uint64_t arrival_cycle;
    uint64_t begin_ns;
    uint64_t cycle;
    uint64_t written_ns;
} records[MOST];

static size_t count;
static double last;
static uint64_t begin_ns;
static _Atomic uint64_t cycle;
static _Atomic uint64_t arrival_ns;
static _Atomic uint64_t arrival_cycle;

static void save(void)
{
    const char *path = getenv("LATENCY_FILE");
    FILE *file = path == NULL ? NULL : fopen(path, "w");
    for (size_t i = 0; file != NULL && i < count; i++) {
        fprintf(file, "%.17g %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 "\n", records[i].value,
                records[i].arrival_ns, records[i].arrival_cycle, records[i].begin_ns, records[i].cycle,
                records[i].written_ns);
    }
    if (file != NULL) {
        fclose(file);
    }
}

void instants_start(void)
{
    count = 0;
    atexit(save);
}

void instants_arrival(void)
{
    atomic_store(&arrival_cycle, atomic_load(&cycle));
    atomic_store(&arrival_ns, epg_port_time_ns());
}

void instants_cycle(void)
{
    begin_ns = epg_port_time_ns();
    atomic_store(&cycle, atomic_load(&cycle) + 1U);
}

/* The values are compared for a change, so an exact comparison is right. */
#pragma GCC diagnostic ignored "-Wfloat-equal"

void instants_write(double value)
{
    if (value == last || count == MOST) {
        return;
    }
    last = value;
    records[count].value = value;
    records[count].arrival_ns = atomic_load(&arrival_ns);
    records[count].arrival_cycle = atomic_load(&arrival_cycle);
    records[count].begin_ns = begin_ns;
    records[count].cycle = atomic_load(&cycle);
    records[count].written_ns = epg_port_time_ns();
    count++;
}
