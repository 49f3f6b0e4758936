/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of signals, in every control cycle or every n-th one, around a trigger, as an oscilloscope does.
 *
 * The recording goes to static memory.  One *row* holds the tick of a cycle and the values of the chosen signals.  The
 * control side records without gaps; the communication side reads the rows afterwards, at its own speed:
 *
 *     epg_capture_start(capture, &request);      // communication side
 *     // epg_capture_cycle() records            // control side, at the end of each cycle
 *     if (epg_capture_idle(capture)) { ... }     // communication side: epg_capture_row() gives the rows
 *
 * The memory belongs to the control side from epg_capture_start() until epg_capture_idle() returns true.
 */
#ifndef EPG_CAPTURE_H
#define EPG_CAPTURE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/handover.h"

/** Largest number of signals in one recording. */
enum { EPG_CAPTURE_SIGNALS = 8 };

/** The event that a recording waits for. */
typedef enum epg_capture_trigger {
    EPG_CAPTURE_NOW,     /**< no event: the next cycle is the trigger */
    EPG_CAPTURE_RISING,  /**< `watched` rises from below `level` to `level` or more */
    EPG_CAPTURE_FALLING, /**< `watched` falls from above `level` to `level` or less */
    EPG_CAPTURE_FAULT    /**< a fault is latched */
} epg_capture_trigger_t;

/** The settings of a recording. */
typedef struct epg_capture_request {
    size_t columns;                             /**< number of signals, 1 ... EPG_CAPTURE_SIGNALS */
    const double *signals[EPG_CAPTURE_SIGNALS]; /**< the values belong to the control side */
    size_t rows;                                /**< at least 1, at most epg_capture_rows() */
    size_t before;                              /**< rows kept from before the trigger; less than `rows` */
    uint32_t every;                             /**< record every n-th cycle; at least 1 */
    epg_capture_trigger_t trigger;
    const double *watched; /**< signal of the triggers by level; else NULL */
    double level;
} epg_capture_request_t;

/** The state of a recorder.  It is valid if all members but `memory` and `capacity` are zero. */
typedef struct epg_capture {
    double *memory;
    size_t capacity; /**< size of `memory`, in doubles */
    size_t lent; /**< doubles at the end of `memory` that recordings must not use; belongs to the communication side */

    epg_handover_t handover; /**< of `memory` and of all members below, except `stop` and `recorded` */
    atomic_bool stop;        /**< request of the communication side to end at once */
    atomic_uint recorded;    /**< rows in memory; written by the control side */
    epg_capture_request_t request;
    bool started;      /**< the control side has seen the request */
    bool triggered;    /**< the trigger has happened; false at the end: the recording was stopped before */
    bool fault_before; /**< a fault was latched one cycle ago */
    double before;     /**< value of `watched` one cycle ago */
    uint32_t until;    /**< cycles until the next row */
    size_t next;       /**< index of the row to write next; the rows are a ring */
    size_t filled;     /**< number of rows that hold values */
    size_t left;       /**< number of rows still to record after the trigger */
    size_t at;         /**< number of rows kept from before the trigger */
} epg_capture_t;

/** Ends a recording that was left when the control loop stopped.  Must be called only while neither side is active. */
void epg_capture_clear(epg_capture_t *capture);

/* Both sides ------------------------------------------------------------------------------------------------- */

/**
 * Returns the row at place `index` of the memory: an array of doubles.  The first one holds the bits of the tick (a
 * 64-bit whole number), the others hold the values.  The rows form a ring, which is overwritten until the trigger.  The
 * trigger then fixes the last row.
 */
static inline double *epg_capture_row_at(const epg_capture_t *capture, size_t index)
{
    return &capture->memory[index * (capture->request.columns + 1U)];
}

/* Control side ----------------------------------------------------------------------------------------------- */

/**
 * Records the cycle of `tick_ns`, if a recording is in progress.  Called at the end of each cycle.  `fault` is true
 * while a fault is latched.
 */
void epg_capture_cycle(epg_capture_t *capture, uint64_t tick_ns, bool fault);

/* Communication side ----------------------------------------------------------------------------------------- */

/** Returns the largest possible number of rows for a recording of `columns` signals. */
size_t epg_capture_rows(const epg_capture_t *capture, size_t columns);

/** Returns true while the memory does not belong to the control side: before, between and after recordings. */
bool epg_capture_idle(epg_capture_t *capture);

/**
 * Lends the second half of the memory to another use, until epg_capture_take_back().  Returns it and sets `*room` to
 * its size in doubles.  A finished recording that reaches into it is lost.  Returns NULL while a recording that reaches
 * into it is in progress.
 */
double *epg_capture_lend(epg_capture_t *capture, size_t *room);

/** Ends the loan. */
void epg_capture_take_back(epg_capture_t *capture);

/** Starts a recording.  `*request` must be within its ranges.  Returns false while another one is in progress. */
bool epg_capture_start(epg_capture_t *capture, const epg_capture_request_t *request);

/** Ends the recording at the next cycle.  The rows that were recorded until then can be read. */
void epg_capture_stop(epg_capture_t *capture);

/** Returns the number of rows recorded so far. */
size_t epg_capture_recorded(epg_capture_t *capture);

/** Returns the index of the trigger's row.  Only while idle, and after a recording that was triggered. */
size_t epg_capture_trigger_row(const epg_capture_t *capture);

/**
 * Gives row `row` of the last recording; row 0 is the oldest.  `*values` then points to one value per signal.  Returns
 * false if there is no such row.  Only while idle.
 */
bool epg_capture_row(const epg_capture_t *capture, size_t row, uint64_t *tick_ns, const double **values);

#endif
