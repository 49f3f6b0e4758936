/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The latch of stops.  epg/stop.h explains it; tests/runtime/stop.pml checks it, statement by statement.
 */
#include "epg/stop.h"

#include "epg/control.h"

/** Returns true for a gate whose own context has stopped: that context knows the order of its requests itself. */
static bool is_own(unsigned int gate, epg_stop_source_t source)
{
    switch (source) {
    case EPG_STOP_LINE:
    case EPG_STOP_FRAME:
    case EPG_STOP_OTHER:
        return gate == EPG_GATE_CONSOLE;
    case EPG_STOP_TOPIC:
        return gate == EPG_GATE_TOPIC || gate == EPG_GATE_EDGE;
    case EPG_STOP_SERVICE:
        return gate == EPG_GATE_SERVICE;
    case EPG_STOP_START:
    case EPG_STOP_PROGRAM:
    case EPG_STOP_SCENARIO:
    case EPG_STOP_FAULT:
    case EPG_STOP_SOURCES:
        break;
    }
    return false;
}

/** Clears all requests, and closes the gates of other contexts. */
static void cancel(epg_latch_t *latch, epg_stop_source_t source)
{
    for (unsigned int i = 0; i < EPG_GATES; i++) {
        if (!is_own(i, source)) {
            atomic_store(&latch->closed[i], 1U);
        }
    }
    for (unsigned int i = 0; i < EPG_REQUESTS; i++) {
        atomic_store(&latch->requests[i], 0U);
    }
    atomic_store(&latch->moves, 0U);
}

void epg_stop(epg_control_t *control, epg_stop_source_t source)
{
    epg_latch_t *latch = &control->latch;
    cancel(latch, source);
    atomic_store(&latch->stopped_by[source], 1U);
    /* Last: when a cycle has taken this stop, no older request is left. */
    atomic_store(&latch->pending, 1U);
}

bool epg_gate_is_open(const epg_control_t *control, epg_gate_t gate)
{
    return gate >= EPG_GATES || atomic_load(&control->latch.closed[gate]) == 0U;
}

void epg_gate_open(epg_control_t *control, epg_gate_t gate)
{
    /* A request that was made while the gate was closed never acts. */
    atomic_store(&control->latch.requests[gate], 0U);
    atomic_store(&control->latch.closed[gate], 0U);
}

bool epg_gate_poll(epg_control_t *control, epg_gate_t gate)
{
    const bool open = epg_gate_is_open(control, gate);
    if (!open) {
        epg_gate_open(control, gate);
    }
    return open;
}

void epg_gate_close(epg_control_t *control, epg_gate_t gate)
{
    atomic_store(&control->latch.closed[gate], 1U);
}

void epg_gate_enable(epg_control_t *control, epg_gate_t gate, unsigned int request)
{
    epg_latch_t *latch = &control->latch;
    if ((request & EPG_ENABLE_AFTER) == 0U) {
        /* A count tells one request from the next.  Two at the same time can have the same count: both act as one. */
        const unsigned int made = atomic_load(&latch->made[gate]) + 1U;
        atomic_store(&latch->made[gate], made);
        request |= made << EPG_ENABLE_SHIFT;
    }
    atomic_store(&latch->requests[gate], request);
}

void epg_control_enable(epg_control_t *control, unsigned int request)
{
    const bool after = (request & EPG_ENABLE_AFTER) != 0U;
    epg_gate_enable(control, after ? EPG_GATE_PROGRAM_AFTER : EPG_GATE_PROGRAM, request);
}

void epg_gate_end_move(epg_control_t *control)
{
    atomic_store(&control->latch.moves, 0U);
}

bool epg_gate_move(epg_control_t *control)
{
    atomic_store(&control->latch.moves, 1U);
    /* In this order: a stop after the question clears `moves`, and one before it has closed the gate. */
    return epg_gate_is_open(control, EPG_GATE_CONSOLE);
}

/** Returns true if the request names the newest stop, or need not name one. */
static bool is_for(unsigned int request, uint64_t number)
{
    return (request & EPG_ENABLE_AFTER) == 0U || ((epg_enable_after(number) ^ request) >> EPG_ENABLE_SHIFT) == 0U;
}

/** Returns a request that may act, and `*gate` that made it; 0: none. */
static unsigned int find_request(const epg_control_t *control, unsigned int *gate)
{
    for (unsigned int i = 0; i < EPG_REQUESTS; i++) {
        /* The gate first: its context clears the request before it opens the gate. */
        if (epg_gate_is_open(control, (epg_gate_t)i)) {
            const unsigned int request = atomic_load(&control->latch.requests[i]);
            if (request != 0U && request != control->latch.acted[i] && is_for(request, control->stop_number)) {
                *gate = i;
                return request;
            }
        }
    }
    return 0U;
}

static void count(epg_control_t *control, epg_stop_source_t source)
{
    control->stop_number = (control->stop_number & ~(uint64_t)UINT32_MAX) | (uint32_t)(control->stop_number + 1U);
    control->stop_ns = control->time_ns;
    control->stop_source = source;
    control->latch.guard = 1U;
}

/** Returns the source of the stop that was taken.  Of several, one is told. */
static epg_stop_source_t take_source(epg_control_t *control)
{
    epg_stop_source_t taken = control->stop_source;
    for (unsigned int i = 0; i < EPG_STOP_SOURCES; i++) {
        if (atomic_load(&control->latch.stopped_by[i]) != 0U) {
            atomic_store(&control->latch.stopped_by[i], 0U);
            taken = (epg_stop_source_t)i;
        }
    }
    return taken;
}

bool epg_stop_take(epg_control_t *control, unsigned int *request)
{
    epg_latch_t *latch = &control->latch;
    unsigned int gate = 0;
    *request = find_request(control, &gate);
    /* Last: a stop that comes between the two clears the request, but this cycle may have read it already. */
    if (atomic_load(&latch->pending) != 0U) {
        atomic_store(&latch->pending, 0U);
        /* A stop may be lost in this store.  The next cycle is disabled for it, and its request is cleared. */
        count(control, take_source(control));
        return true;
    }
    if (latch->guard > 0U) {
        latch->guard--;
        return true;
    }
    if (*request != 0U) {
        /* It acts once, also if it came while a stop was under way that this cycle does not see yet. */
        latch->acted[gate] = *request;
    }
    return false;
}

void epg_stop_cancel(epg_control_t *control)
{
    cancel(&control->latch, EPG_STOP_FAULT);
}

void epg_stop_count(epg_control_t *control, epg_stop_source_t source)
{
    cancel(&control->latch, source);
    count(control, source);
}
