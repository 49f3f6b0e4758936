/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Telemetry: the communication side's part.
 */
#include "epg/telemetry.h"

#include <string.h>

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
    const double *found = epg_telemetry_row_at(telemetry, telemetry->taken_at);
    memcpy(&row->number, &found[0], sizeof row->number);
    memcpy(&row->tick_ns, &found[1], sizeof row->tick_ns);
    row->values = found + EPG_TELEMETRY_HEAD;
    return true;
}

void epg_telemetry_drop(epg_telemetry_t *telemetry)
{
    telemetry->taken_at = epg_telemetry_next(telemetry, telemetry->taken_at);
    atomic_store_explicit(&telemetry->taken, atomic_load_explicit(&telemetry->taken, memory_order_relaxed) + 1U,
                          memory_order_release);
}
