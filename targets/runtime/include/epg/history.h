/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A history: the monitoring values of the newest control cycles, in their order.
 *
 * An exchange (epg/exchange.h) passes the newest value only.  A history passes every value, as long as the reader
 * follows: a publication of every control cycle leaves none out, although the communication side runs less often.
 *
 * The control side adds a record, the communication side takes it.  Neither waits.  If the history is full, the record
 * is lost, and counted.
 */
#ifndef EPG_HISTORY_H
#define EPG_HISTORY_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef struct epg_history {
    double *values; /**< `depth` records of `count` numbers */
    size_t count;
    uint32_t depth;
    atomic_uint added; /**< number of records ever added, modulo 2^32; written by the control side */
    atomic_uint taken; /**< number of records ever taken, modulo 2^32; written by the communication side */
    atomic_uint lost;  /**< number of records that found no room, modulo 2^32; written by the control side */
    uint32_t add_at;   /**< index of the next record to add; belongs to the control side */
    uint32_t take_at;  /**< index of the oldest record; belongs to the communication side */
} epg_history_t;

/** Makes the history empty.  Must be called only while neither side uses it. */
static inline void epg_history_clear(epg_history_t *history)
{
    atomic_store(&history->added, 0U);
    atomic_store(&history->taken, 0U);
    atomic_store(&history->lost, 0U);
    history->add_at = 0U;
    history->take_at = 0U;
}

/** Adds a record of `count` numbers.  Control side. */
static inline void epg_history_add(epg_history_t *history, const double *values)
{
    const unsigned int added = atomic_load_explicit(&history->added, memory_order_relaxed);
    if ((uint32_t)(added - atomic_load_explicit(&history->taken, memory_order_acquire)) >= history->depth) {
        atomic_store(&history->lost, atomic_load(&history->lost) + 1U);
        return;
    }
    memcpy(&history->values[history->add_at * history->count], values, history->count * sizeof *values);
    history->add_at = history->add_at + 1U == history->depth ? 0U : history->add_at + 1U;
    atomic_store_explicit(&history->added, added + 1U, memory_order_release);
}

/** Copies the oldest record to `values`; it stays there.  Returns false if there is none.  Communication side. */
static inline bool epg_history_peek(const epg_history_t *history, double *values)
{
    if (atomic_load_explicit(&history->added, memory_order_acquire) ==
        atomic_load_explicit(&history->taken, memory_order_relaxed)) {
        return false;
    }
    memcpy(values, &history->values[history->take_at * history->count], history->count * sizeof *values);
    return true;
}

/** Takes the oldest record out.  Must be called only after epg_history_peek() has returned true.  Communication side. */
static inline void epg_history_drop(epg_history_t *history)
{
    history->take_at = history->take_at + 1U == history->depth ? 0U : history->take_at + 1U;
    atomic_store_explicit(&history->taken, atomic_load_explicit(&history->taken, memory_order_relaxed) + 1U,
                          memory_order_release);
}

/** Takes out all records that are there now.  Communication side. */
static inline void epg_history_drop_all(epg_history_t *history)
{
    const unsigned int added = atomic_load_explicit(&history->added, memory_order_acquire);
    while (atomic_load_explicit(&history->taken, memory_order_relaxed) != added) {
        epg_history_drop(history);
    }
}

#endif
