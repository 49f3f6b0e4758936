/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of signals: the control side's part.
 */
#include "epg/capture.h"

#include <string.h>

void epg_capture_clear(epg_capture_t *capture)
{
    epg_handover_clear(&capture->handover);
}

/** Returns true if this cycle is the trigger. */
static bool fires(epg_capture_t *capture, bool fault)
{
    const epg_capture_request_t *request = &capture->request;
    const double value = request->watched != NULL ? *request->watched : 0.0;
    const double before = capture->started ? capture->before : value;
    const bool fault_before = capture->started ? capture->fault_before : fault;
    capture->before = value;
    capture->fault_before = fault;
    capture->started = true;
    switch (request->trigger) {
    case EPG_CAPTURE_NOW:
        return true;
    case EPG_CAPTURE_RISING:
        return before < request->level && value >= request->level;
    case EPG_CAPTURE_FALLING:
        return before > request->level && value <= request->level;
    case EPG_CAPTURE_FAULT:
        return fault && !fault_before;
    }
    return false;
}

static void record(epg_capture_t *capture, uint64_t tick_ns)
{
    const epg_capture_request_t *request = &capture->request;
    double *row = epg_capture_row_at(capture, capture->next);
    memcpy(row, &tick_ns, sizeof tick_ns);
    for (size_t i = 0; i < request->columns; i++) {
        row[1U + i] = *request->signals[i];
    }
    capture->next = capture->next + 1U == request->rows ? 0U : capture->next + 1U;
    if (capture->filled < request->rows) {
        capture->filled++;
    }
    atomic_store(&capture->recorded, (unsigned int)capture->filled);
}

void epg_capture_cycle(epg_capture_t *capture, uint64_t tick_ns, bool fault)
{
    if (!epg_handover_there(&capture->handover)) {
        return;
    }
    if (atomic_load(&capture->stop)) {
        epg_handover_return(&capture->handover);
        return;
    }
    const epg_capture_request_t *request = &capture->request;
    if (!capture->triggered && fires(capture, fault)) {
        capture->triggered = true;
        capture->at = capture->filled < request->before ? capture->filled : request->before;
        capture->left = request->rows - capture->at;
        capture->until = 0; /* the cycle of the trigger has a row */
    }
    if (capture->until > 0) {
        capture->until--;
        return;
    }
    capture->until = request->every - 1U;
    record(capture, tick_ns);
    if (capture->triggered) {
        capture->left--;
        if (capture->left == 0) {
            epg_handover_return(&capture->handover);
        }
    }
}
