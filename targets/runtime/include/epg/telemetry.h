/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Telemetry: rows of chosen signals, taken in every n-th control cycle, which are sent while the control loop runs.
 *
 * One *row* holds the number of the row, the tick of its cycle, and the values of the signals after the outputs were
 * written.  The control side puts rows into a ring in static memory, the communication side takes them out and sends
 * them.  Neither side waits.  If the ring is full, the whole row is dropped.  Dropped rows have a number, too, so that
 * the receiver sees each gap.
 *
 *     epg_telemetry_start(&telemetry, &request, memory, capacity);              // communication side
 *     // epg_control_cycle() puts rows into the ring                             // control side, at the end of a cycle
 *     while (epg_telemetry_row(&telemetry, &row)) { ...; epg_telemetry_drop(&telemetry); }
 *
 * Capture (epg/capture.h) records a limited time without gaps, and is read afterwards.
 */
#ifndef EPG_TELEMETRY_H
#define EPG_TELEMETRY_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/handover.h"

/** Largest number of signals in one stream, and number of doubles that a row needs beside its values. */
enum { EPG_TELEMETRY_SIGNALS = 32, EPG_TELEMETRY_HEAD = 2 };

/** The settings of a stream. */
typedef struct epg_telemetry_request {
    size_t columns;                               /**< number of signals, 1 ... EPG_TELEMETRY_SIGNALS */
    const double *signals[EPG_TELEMETRY_SIGNALS]; /**< the values belong to the control side */
    uint32_t every;                               /**< a row in every n-th cycle; at least 1 */
} epg_telemetry_request_t;

/** A row, as the communication side gets it. */
typedef struct epg_telemetry_row {
    uint64_t number;      /**< number of the row since the start of the stream, from 0; dropped rows count */
    uint64_t tick_ns;     /**< tick of its cycle, in board time */
    const double *values; /**< one for each signal */
} epg_telemetry_row_t;

/** The state of a stream.  Zero-initialised memory is a valid, stopped stream. */
typedef struct epg_telemetry {
    epg_handover_t handover; /**< of the members below; "there" while the stream runs */
    atomic_bool stop;        /**< request of the communication side to end the stream */
    epg_telemetry_request_t request;
    double *memory;
    uint32_t depth;    /**< number of rows for which `memory` has room */
    atomic_uint put;   /**< number of rows ever put in, modulo 2^32; written by the control side */
    atomic_uint taken; /**< number of rows ever taken out, modulo 2^32; written by the communication side */
    uint32_t put_at;   /**< index of the next row to write; belongs to the control side */
    uint32_t taken_at; /**< index of the oldest row; belongs to the communication side */
    uint32_t until;    /**< cycles until the next row; belongs to the control side */
    uint64_t number;   /**< number of the next row; belongs to the control side */
} epg_telemetry_t;

/** Ends a stream that was left when the control loop stopped.  Must be called only while neither side is active. */
void epg_telemetry_clear(epg_telemetry_t *telemetry);

/* Both sides ------------------------------------------------------------------------------------------------- */

/**
 * Returns the row at place `index` of the ring: an array of doubles.  The first two hold the bits of its number and of
 * its tick (64-bit whole numbers), the others hold the values.
 */
static inline double *epg_telemetry_row_at(const epg_telemetry_t *telemetry, uint32_t index)
{
    return &telemetry->memory[index * (telemetry->request.columns + EPG_TELEMETRY_HEAD)];
}

/** Returns the place after `index` in the ring. */
static inline uint32_t epg_telemetry_next(const epg_telemetry_t *telemetry, uint32_t index)
{
    return index + 1U == telemetry->depth ? 0U : index + 1U;
}

/* Control side ----------------------------------------------------------------------------------------------- */

/** Puts the row of a stream that runs into its ring, or drops the row if the ring is full. */
void epg_telemetry_put(epg_telemetry_t *telemetry, uint64_t tick_ns);

/* Communication side ----------------------------------------------------------------------------------------- */

/** Returns the largest number of rows of `columns` signals in a memory of `capacity` doubles. */
uint32_t epg_telemetry_depth(size_t columns, size_t capacity);

/**
 * Starts a stream.  `*request` must be within its ranges, and `memory` must have room for at least one row; it belongs
 * to the stream until epg_telemetry_idle() returns true.  Returns false while another stream runs.
 */
bool epg_telemetry_start(epg_telemetry_t *telemetry, const epg_telemetry_request_t *request, double *memory,
                         size_t capacity);

/** Ends the stream at the next cycle.  Rows that are still in the ring are lost. */
void epg_telemetry_stop(epg_telemetry_t *telemetry);

/** Returns true while no stream runs. */
bool epg_telemetry_idle(epg_telemetry_t *telemetry);

/** Gives the oldest row, which stays in the ring.  Returns false if there is none. */
bool epg_telemetry_row(const epg_telemetry_t *telemetry, epg_telemetry_row_t *row);

/** Takes the oldest row out.  Must be called only after epg_telemetry_row() has returned true. */
void epg_telemetry_drop(epg_telemetry_t *telemetry);

#endif
