/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A block of memory that belongs to one of two contexts at a time.
 *
 * The giver fills the block and gives it away; the taker works on it, over as many control cycles as it needs, and
 * gives it back with its answer in it.  Neither waits: each asks whose the block is.  Where the exchange keeps only the
 * newest value, nothing given here is ever lost.
 *
 * Needs loads and stores of single words only, which are sequentially consistent: what one side wrote to the block
 * before it let go of it is what the other side finds.
 */
#ifndef EPG_HANDOVER_H
#define EPG_HANDOVER_H

#include <stdatomic.h>
#include <stdbool.h>

/** Zero-initialised memory is a valid start: the block is the giver's. */
typedef struct epg_handover {
    atomic_uint given;    /**< times it was given away; written by the giver */
    atomic_uint returned; /**< times it came back; written by the taker */
} epg_handover_t;

/** Giver: true while the block is the giver's. */
static inline bool epg_handover_here(epg_handover_t *handover)
{
    return atomic_load(&handover->returned) == atomic_load(&handover->given);
}

/** Giver: gives the block away.  Only while it is the giver's. */
static inline void epg_handover_give(epg_handover_t *handover)
{
    atomic_store(&handover->given, atomic_load(&handover->given) + 1U);
}

/** Makes the block the giver's.  Only while neither side uses it. */
static inline void epg_handover_clear(epg_handover_t *handover)
{
    atomic_store(&handover->given, 0U);
    atomic_store(&handover->returned, 0U);
}

/** Taker: true while the block is the taker's. */
static inline bool epg_handover_there(epg_handover_t *handover)
{
    return atomic_load(&handover->given) != atomic_load(&handover->returned);
}

/** Taker: gives the block back.  Only while it is the taker's. */
static inline void epg_handover_return(epg_handover_t *handover)
{
    atomic_store(&handover->returned, atomic_load(&handover->given));
}

#endif
