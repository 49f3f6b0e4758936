/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Recording of chosen signals at every control cycle, around a trigger, into static memory.
 *
 * The communication side chooses and reads; the control side records.  The memory is the control side's from
 * epg_capture_start() until epg_capture_idle() says so.
 */
#ifndef EPG_CAPTURE_H
#define EPG_CAPTURE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/handover.h"

/** Most signals of one recording. */
enum { EPG_CAPTURE_SIGNALS = 8 };

typedef enum epg_capture_trigger {
    EPG_CAPTURE_NOW,     /**< with the next cycle */
    EPG_CAPTURE_RISING,  /**< `watched` was below `level`, and is no longer */
    EPG_CAPTURE_FALLING, /**< `watched` was above `level`, and is no longer */
    EPG_CAPTURE_FAULT    /**< a fault is latched */
} epg_capture_trigger_t;

/** What is to be recorded. */
typedef struct epg_capture_request {
    size_t columns;                             /**< 1 ... EPG_CAPTURE_SIGNALS */
    const double *signals[EPG_CAPTURE_SIGNALS]; /**< belong to the control side */
    size_t rows;                                /**< at least 1, at most epg_capture_rows() */
    size_t before;                              /**< rows kept from before the trigger; less than `rows` */
    uint32_t every;                             /**< record every n-th cycle; at least 1 */
    epg_capture_trigger_t trigger;
    const double *watched; /**< of a trigger by level */
    double level;
} epg_capture_request_t;

/** Zero-initialised but for `memory` and `capacity`, it is a valid start. */
typedef struct epg_capture {
    double *memory;
    size_t capacity; /**< of `memory`, in doubles */

    epg_handover_t handover; /**< of `memory` and all that follows, but for `stop` and `recorded` */
    atomic_bool stop;        /**< the communication side asks the control side to end at once */
    atomic_uint recorded;    /**< rows in memory; written by the control side */
    epg_capture_request_t request;
    bool started;      /**< the control side has seen the request */
    bool triggered;    /**< false at the end: stopped before that */
    bool fault_before; /**< a fault was latched one cycle ago */
    double before;     /**< `watched` one cycle ago */
    uint32_t until;    /**< cycles until the next row */
    size_t next;       /**< row that is written next; the rows are a ring */
    size_t filled;     /**< rows that hold something */
    size_t left;       /**< rows still to come after the trigger */
    size_t at;         /**< rows from before the trigger that are kept */
} epg_capture_t;

/** Ends a recording that a stop of the control loop has left.  While neither side is active. */
void epg_capture_clear(epg_capture_t *capture);

/* Control side ----------------------------------------------------------------------------------------------- */

/** Records, if that is asked for, the cycle of `tick_ns` at its end; `fault`: a fault is latched. */
void epg_capture_cycle(epg_capture_t *capture, uint64_t tick_ns, bool fault);

/* Communication side ----------------------------------------------------------------------------------------- */

/** Most rows of a recording of `columns` signals. */
size_t epg_capture_rows(const epg_capture_t *capture, size_t columns);

/** True while the control side has nothing to do with the memory: before, between and after recordings. */
bool epg_capture_idle(epg_capture_t *capture);

/** Asks for a recording, whose numbers are within the ranges above; false while one is going on. */
bool epg_capture_start(epg_capture_t *capture, const epg_capture_request_t *request);

/** Ends a recording with the next cycle; what has been recorded by then can be read. */
void epg_capture_stop(epg_capture_t *capture);

/** Rows recorded so far. */
size_t epg_capture_recorded(epg_capture_t *capture);

/** While idle, after a recording that was triggered: the row of the trigger. */
size_t epg_capture_trigger_row(const epg_capture_t *capture);

/**
 * While idle: row `row` of the last recording, from the oldest on.  `*values` holds as many values as signals were
 * chosen.  False when there is no such row.
 */
bool epg_capture_row(const epg_capture_t *capture, size_t row, uint64_t *tick_ns, const double **values);

#endif
