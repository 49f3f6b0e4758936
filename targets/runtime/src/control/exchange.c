/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Simpson's four-slot mechanism; his slots are called buffers here.
 *
 * Four buffers form two pairs.  The writer avoids the pair that the reader uses, and within the other pair it avoids
 * the buffer that was written last.  The reader announces its pair before it looks up the newest buffer in it.
 *
 * tests/runtime/exchange.pml is the same algorithm, statement by statement, for a model checker.
 */
#include "epg/exchange.h"

#include <string.h>

static void *buffer(const epg_exchange_t *exchange, unsigned int pair, unsigned int index)
{
    return (unsigned char *)exchange->buffers + (size_t)(2U * pair + index) * exchange->size;
}

void epg_exchange_clear(epg_exchange_t *exchange)
{
    exchange->taken = 0U;
    atomic_store(&exchange->writes, 0U);
    atomic_store(&exchange->latest, 0U);
    atomic_store(&exchange->reading, 0U);
    atomic_store(&exchange->newest[0], 0U);
    atomic_store(&exchange->newest[1], 0U);
}

void epg_exchange_write(epg_exchange_t *exchange, const void *value)
{
    const unsigned int pair = 1U - atomic_load(&exchange->reading);
    const unsigned int index = 1U - atomic_load(&exchange->newest[pair]);
    memcpy(buffer(exchange, pair, index), value, exchange->size);
    atomic_store(&exchange->newest[pair], index);
    atomic_store(&exchange->latest, pair);
    atomic_store(&exchange->writes, (atomic_load(&exchange->writes) + 2U) | 1U);
}

bool epg_exchange_read(epg_exchange_t *exchange, void *value)
{
    if (atomic_load(&exchange->writes) == 0U) {
        return false;
    }
    const unsigned int pair = atomic_load(&exchange->latest);
    atomic_store(&exchange->reading, pair);
    const unsigned int index = atomic_load(&exchange->newest[pair]);
    memcpy(value, buffer(exchange, pair, index), exchange->size);
    return true;
}

bool epg_exchange_take(epg_exchange_t *exchange, void *value)
{
    /*
     * The counter must be read before the value.  If a write finishes in between, this call gives its value, and the
     * next call gives it once more.  In the other order, the value could be lost.
     */
    const unsigned int writes = atomic_load(&exchange->writes);
    if (writes == exchange->taken) {
        return false;
    }
    exchange->taken = writes;
    return epg_exchange_read(exchange, value);
}
