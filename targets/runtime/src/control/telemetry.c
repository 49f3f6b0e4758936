/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Telemetry: the control side's part.
 */
#include "epg/telemetry.h"

#include <string.h>

void epg_telemetry_clear(epg_telemetry_t *telemetry)
{
    epg_handover_clear(&telemetry->handover);
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
    double *row = epg_telemetry_row_at(telemetry, telemetry->put_at);
    memcpy(&row[0], &number, sizeof number);
    memcpy(&row[1], &tick_ns, sizeof tick_ns);
    for (size_t i = 0; i < telemetry->request.columns; i++) {
        row[EPG_TELEMETRY_HEAD + i] = *telemetry->request.signals[i];
    }
    telemetry->put_at = epg_telemetry_next(telemetry, telemetry->put_at);
    atomic_store_explicit(&telemetry->put, put + 1U, memory_order_release);
}
