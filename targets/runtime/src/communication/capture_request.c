/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of signals: the communication side's part.
 */
#include "epg/capture.h"

#include <string.h>

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
    const double *found =
        epg_capture_row_at(capture, index < capture->request.rows ? index : index - capture->request.rows);
    memcpy(tick_ns, found, sizeof *tick_ns);
    *values = found + 1;
    return true;
}
