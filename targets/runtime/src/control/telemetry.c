/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Telemetry: the control side's part and the communication side's part.
 *
 * A row is an array of doubles.  The first two hold the bits of its number and of its tick (64-bit whole numbers), the
 * others hold the values.
 */
#include "epg/telemetry.h"

#include <string.h>

void epg_telemetry_clear(epg_telemetry_t *telemetry)
{
    epg_handover_clear(&telemetry->handover);
}

static double *row_at(const epg_telemetry_t *telemetry, uint32_t index)
{
    return &telemetry->memory[index * (telemetry->request.columns + EPG_TELEMETRY_HEAD)];
}

static uint32_t next(const epg_telemetry_t *telemetry, uint32_t index)
{
    return index + 1U == telemetry->depth ? 0U : index + 1U;
}

void epg_telemetry_put(epg_telemetry_t *telemetry, uint64_t tick_ns)
{
    if (atomic_load(&telemetry->stop)) {
        epg_handover_return(&telemetry->handover);
        return;
    }
    if (telemetry->until > 0U) {
        telemetry->until--;
        return;
    }
    telemetry->until = telemetry->request.every - 1U;
    const uint64_t number = telemetry->number++;
    const unsigned int put = atomic_load_explicit(&telemetry->put, memory_order_relaxed);
    if (put - atomic_load_explicit(&telemetry->taken, memory_order_acquire) >= telemetry->depth) {
        return;
    }
    double *row = row_at(telemetry, telemetry->put_at);
    memcpy(&row[0], &number, sizeof number);
    memcpy(&row[1], &tick_ns, sizeof tick_ns);
    for (size_t i = 0; i < telemetry->request.columns; i++) {
        row[EPG_TELEMETRY_HEAD + i] = *telemetry->request.signals[i];
    }
    telemetry->put_at = next(telemetry, telemetry->put_at);
    atomic_store_explicit(&telemetry->put, put + 1U, memory_order_release);
}

/* Communication side ------------------------------------------------------------------------------------------- */

uint32_t epg_telemetry_depth(size_t columns, size_t capacity)
{
    return (uint32_t)(capacity / (columns + EPG_TELEMETRY_HEAD));
}

bool epg_telemetry_start(epg_telemetry_t *telemetry, const epg_telemetry_request_t *request, double *memory,
                         size_t capacity)
{
    if (!epg_handover_here(&telemetry->handover)) {
        return false;
    }
    telemetry->request = *request;
    telemetry->memory = memory;
    telemetry->depth = epg_telemetry_depth(request->columns, capacity);
    telemetry->put_at = 0;
    telemetry->taken_at = 0;
    telemetry->until = 0;
    telemetry->number = 0;
    atomic_store(&telemetry->put, 0U);
    atomic_store(&telemetry->taken, 0U);
    atomic_store(&telemetry->stop, false);
    epg_handover_give(&telemetry->handover);
    return true;
}

void epg_telemetry_stop(epg_telemetry_t *telemetry)
{
    atomic_store(&telemetry->stop, true);
}

bool epg_telemetry_idle(epg_telemetry_t *telemetry)
{
    return epg_handover_here(&telemetry->handover);
}

bool epg_telemetry_row(const epg_telemetry_t *telemetry, epg_telemetry_row_t *row)
{
    if (atomic_load_explicit(&telemetry->put, memory_order_acquire) ==
        atomic_load_explicit(&telemetry->taken, memory_order_relaxed)) {
        return false;
    }
    const double *found = row_at(telemetry, telemetry->taken_at);
    memcpy(&row->number, &found[0], sizeof row->number);
    memcpy(&row->tick_ns, &found[1], sizeof row->tick_ns);
    row->values = found + EPG_TELEMETRY_HEAD;
    return true;
}

void epg_telemetry_drop(epg_telemetry_t *telemetry)
{
    telemetry->taken_at = next(telemetry, telemetry->taken_at);
    atomic_store_explicit(&telemetry->taken, atomic_load_explicit(&telemetry->taken, memory_order_relaxed) + 1U,
                          memory_order_release);
}
