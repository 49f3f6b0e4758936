/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Wait-free exchange of the newest value between one writer and one reader.
 *
 * A value of any size is written and read as a whole: a reader never sees half of an update, never sees an older value
 * after a newer one, and neither side ever waits or retries.  Needs only loads and stores of single
 * words, so it works between the two cores of an RP2040, which has no exclusive-access instructions.
 *
 * Algorithm: H. Simpson, "Four-slot fully asynchronous communication mechanism", IEE Proceedings E 137(1), 1990;
 * his slots are called buffers here.
 * The control words are sequentially consistent C11 atomics, which the algorithm needs on out-of-order memory and
 * against reordering by the compiler.  Reading and writing take a constant time: one copy each.
 */
#ifndef EPG_EXCHANGE_H
#define EPG_EXCHANGE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** State of one exchange.  Zero-initialised memory plus `buffers` and `size` is a valid, empty exchange. */
typedef struct epg_exchange {
    void *buffers;         /**< 4 * `size` bytes */
    size_t size;           /**< bytes of one value */
    atomic_uint latest;    /**< pair written last: 0 or 1 */
    atomic_uint reading;   /**< pair the reader works on: 0 or 1 */
    atomic_uint newest[2]; /**< buffer written last in each pair: 0 or 1 */
    atomic_uint writes;    /**< 0 before the first write has finished, then odd; each write adds 2, modulo 2^32 */
    unsigned int taken;    /**< the reader's: `writes` when epg_exchange_take() last gave a value */
} epg_exchange_t;

/** Static initialiser; `storage` is an array of four values. */
/* clang-format off */
#define EPG_EXCHANGE(storage) {.buffers = (storage), .size = sizeof((storage)[0])}
/* clang-format on */

/** Makes it empty again.  Only while neither side uses it. */
void epg_exchange_clear(epg_exchange_t *exchange);

/** Publishes `*value` (`size` bytes).  Only one context may write. */
void epg_exchange_write(epg_exchange_t *exchange, const void *value);

/** Copies the newest value to `*value`; false (and `*value` untouched) before the first write.  Only one context may read. */
bool epg_exchange_read(epg_exchange_t *exchange, void *value);

/**
 * As epg_exchange_read(), but also false when no write has finished since it last gave a value: then that one is the
 * newest still.  Spares the copy.
 */
bool epg_exchange_take(epg_exchange_t *exchange, void *value);

#endif
