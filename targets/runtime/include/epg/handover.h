/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A handover: a block of memory that belongs to one of two contexts at a time.
 *
 * The giver fills the block and gives it away.  The taker uses it, over as many control cycles as it needs, writes its
 * answer into it, and returns it.  Neither side waits; each asks to whom the block belongs.  An exchange
 * (epg/exchange.h) keeps only the newest value; a handover, by contrast, never loses what was given.
 *
 *     if (epg_handover_here(&handover)) { block = request; epg_handover_give(&handover); }         // giver
 *     if (epg_handover_there(&handover)) { work_on(&block); epg_handover_return(&handover); }      // taker
 *
 * A handover needs only loads and stores of single words.  They are sequentially consistent.  Everything that one side
 * wrote to the block before it gave the block away is therefore visible to the other side.
 */
#ifndef EPG_HANDOVER_H
#define EPG_HANDOVER_H

#include <stdatomic.h>
#include <stdbool.h>

/** Zero-initialised memory is a valid handover: the block belongs to the giver. */
typedef struct epg_handover {
    atomic_uint given;    /**< how often the block was given away; written by the giver */
    atomic_uint returned; /**< how often it was returned; written by the taker */
} epg_handover_t;

/** For the giver: true while the block belongs to the giver. */
static inline bool epg_handover_here(epg_handover_t *handover)
{
    return atomic_load(&handover->returned) == atomic_load(&handover->given);
}

/** For the giver: gives the block away.  Must be called only while it belongs to the giver. */
static inline void epg_handover_give(epg_handover_t *handover)
{
    atomic_store(&handover->given, atomic_load(&handover->given) + 1U);
}

/** Makes the block belong to the giver.  Must be called only while neither side uses it. */
static inline void epg_handover_clear(epg_handover_t *handover)
{
    atomic_store(&handover->given, 0U);
    atomic_store(&handover->returned, 0U);
}

/** For the taker: true while the block belongs to the taker. */
static inline bool epg_handover_there(epg_handover_t *handover)
{
    return atomic_load_explicit(&handover->returned, memory_order_relaxed) !=
           atomic_load_explicit(&handover->given, memory_order_acquire);
}

/** For the taker: returns the block.  Must be called only while it belongs to the taker. */
static inline void epg_handover_return(epg_handover_t *handover)
{
    atomic_store(&handover->returned, atomic_load(&handover->given));
}

#endif
