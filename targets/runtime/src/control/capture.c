/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of signals: the control side's part and the communication side's part.
 *
 * A row is an array of doubles.  The first one holds the bits of the tick (a 64-bit whole number), the others hold the
 * values.  The rows form a ring, which is overwritten until the trigger.  The trigger then fixes the last row.
 */
#include "epg/capture.h"

#include <string.h>

void epg_capture_clear(epg_capture_t *capture)
{
    epg_handover_clear(&capture->handover);
}

static double *row_at(const epg_capture_t *capture, size_t index)
{
    return &capture->memory[index * (capture->request.columns + 1U)];
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
    double *row = row_at(capture, capture->next);
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

/* Communication side ------------------------------------------------------------------------------------------- */

size_t epg_capture_rows(const epg_capture_t *capture, size_t columns)
{
    return (capture->capacity - capture->lent) / (columns + 1U);
}

double *epg_capture_lend(epg_capture_t *capture, size_t *room)
{
    const size_t kept = capture->capacity / 2U;
    const bool reaches = capture->request.rows * (capture->request.columns + 1U) > kept;
    if (reaches && !epg_capture_idle(capture)) {
        return NULL;
    }
    if (reaches) {
        capture->filled = 0;
        atomic_store(&capture->recorded, 0U);
    }
    capture->lent = capture->capacity - kept;
    *room = capture->lent;
    return &capture->memory[kept];
}

void epg_capture_take_back(epg_capture_t *capture)
{
    capture->lent = 0;
}

bool epg_capture_idle(epg_capture_t *capture)
{
    return epg_handover_here(&capture->handover);
}

bool epg_capture_start(epg_capture_t *capture, const epg_capture_request_t *request)
{
    if (!epg_handover_here(&capture->handover)) {
        return false;
    }
    capture->request = *request;
    capture->started = false;
    capture->triggered = false;
    capture->until = 0;
    capture->next = 0;
    capture->filled = 0;
    capture->left = 0;
    capture->at = 0;
    atomic_store(&capture->recorded, 0U);
    atomic_store(&capture->stop, false);
    epg_handover_give(&capture->handover);
    return true;
}

void epg_capture_stop(epg_capture_t *capture)
{
    atomic_store(&capture->stop, true);
}

size_t epg_capture_recorded(epg_capture_t *capture)
{
    return atomic_load(&capture->recorded);
}

size_t epg_capture_trigger_row(const epg_capture_t *capture)
{
    return capture->filled - (capture->request.rows - capture->at - capture->left);
}

bool epg_capture_row(const epg_capture_t *capture, size_t row, uint64_t *tick_ns, const double **values)
{
    if (row >= capture->filled) {
        return false;
    }
    const size_t oldest = capture->filled < capture->request.rows ? 0U : capture->next;
    const size_t index = oldest + row;
    const double *found = row_at(capture, index < capture->request.rows ? index : index - capture->request.rows);
    memcpy(tick_ns, found, sizeof *tick_ns);
    *values = found + 1;
    return true;
}
