/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An exchange: passes the newest value of one writer to one reader, without waiting.
 *
 * A value can have any size.  It is written and read as a whole: the reader never gets half of an update, and never an
 * older value after a newer one.  A value that is replaced before it was read is lost.  Neither side ever waits or
 * retries, so the writer can be an interrupt and the reader a thread, or each can run on a core of its own.
 *
 *     static double storage[4][3];                               // four buffers for a value of three numbers
 *     static epg_exchange_t exchange = EPG_EXCHANGE(storage);
 *     epg_exchange_write(&exchange, position);                   // writer: const double position[3]
 *     if (epg_exchange_read(&exchange, copy)) { ... }            // reader: double copy[3]
 *
 * Algorithm: H. Simpson, "Four-slot fully asynchronous communication mechanism", IEE Proceedings E 137(1), 1990;
 * his slots are called buffers here.  It needs only loads and stores of single words, so it works between the two cores
 * of an RP2040, which has no exclusive-access instructions.  The control words are sequentially consistent C11 atomics:
 * the algorithm needs this on memory that is accessed out of order, and against reordering by the compiler.  Reading
 * and writing take a constant time, one copy each.
 */
#ifndef EPG_EXCHANGE_H
#define EPG_EXCHANGE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** The state of one exchange.  It is a valid, empty exchange if all members but `buffers` and `size` are zero. */
typedef struct epg_exchange {
    void *buffers;         /**< 4 * `size` bytes */
    size_t size;           /**< bytes of one value */
    atomic_uint latest;    /**< the pair of buffers written last: 0 or 1 */
    atomic_uint reading;   /**< the pair that the reader uses: 0 or 1 */
    atomic_uint newest[2]; /**< for each pair, the buffer written last: 0 or 1 */
    atomic_uint writes;    /**< 0 before the first write has finished, then odd; each write adds 2, modulo 2^32 */
    unsigned int taken;    /**< belongs to the reader: `writes` at the last successful epg_exchange_take() */
} epg_exchange_t;

/** Initialiser of a static exchange; `storage` is an array of four values. */
/* clang-format off */
#define EPG_EXCHANGE(storage) {.buffers = (storage), .size = sizeof((storage)[0])}
/* clang-format on */

/** Makes the exchange empty again.  Must be called only while neither side uses it. */
void epg_exchange_clear(epg_exchange_t *exchange);

/** Publishes `*value` (`size` bytes).  Only one context may write. */
void epg_exchange_write(epg_exchange_t *exchange, const void *value);

/**
 * Copies the newest value to `*value`.  Returns false, and leaves `*value` as it is, before the first write.  Only one
 * context may read.
 */
bool epg_exchange_read(epg_exchange_t *exchange, void *value);

/**
 * As epg_exchange_read(), but copies a value only if a write has finished since the last value that this function
 * gave.  Otherwise it returns false: that value is still the newest.
 */
bool epg_exchange_take(epg_exchange_t *exchange, void *value);

/** Returns true if epg_exchange_take() would give a value.  Only the reader may call it; costs less than that call. */
static inline bool epg_exchange_has_news(epg_exchange_t *exchange)
{
    /* epg_exchange_take() orders its reads itself. */
    return atomic_load_explicit(&exchange->writes, memory_order_relaxed) != exchange->taken;
}

#endif
