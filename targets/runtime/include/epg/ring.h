/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A ring of bytes between an interrupt and the communication side: one puts in, the other takes out, neither waits.
 *
 * Positions run on modulo 2^32 and are each written by one side only, so that loads and stores of single words do:
 * what is ahead of `put` is not read, and what is behind `taken` is not written.
 */
#ifndef EPG_RING_H
#define EPG_RING_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct epg_ring {
    unsigned char *bytes;
    uint32_t size;     /**< of `bytes`, at most 2^31 */
    atomic_uint put;   /**< bytes that were ever put in: the writer's */
    atomic_uint taken; /**< bytes that were ever taken out: the reader's */
    uint32_t put_at;   /**< index of the next byte to write: the writer's */
    uint32_t taken_at; /**< index of the next byte to read: the reader's */
    atomic_uint lost;  /**< bytes that there was no room for: the writer's */
} epg_ring_t;

/** How many bytes there are to take.  Either side. */
static inline uint32_t epg_ring_count(const epg_ring_t *ring)
{
    return (uint32_t)(atomic_load_explicit(&ring->put, memory_order_acquire) -
                      atomic_load_explicit(&ring->taken, memory_order_acquire));
}

/** How many bytes there is room for.  Either side. */
static inline uint32_t epg_ring_room(const epg_ring_t *ring)
{
    return ring->size - epg_ring_count(ring);
}

/** Puts a byte in, or counts it as lost when there is no room.  The writer's. */
static inline void epg_ring_put(epg_ring_t *ring, unsigned char byte)
{
    if (epg_ring_room(ring) == 0U) {
        atomic_store_explicit(&ring->lost, atomic_load_explicit(&ring->lost, memory_order_relaxed) + 1U,
                              memory_order_relaxed);
        return;
    }
    ring->bytes[ring->put_at] = byte;
    ring->put_at = ring->put_at + 1U == ring->size ? 0U : ring->put_at + 1U;
    atomic_store_explicit(&ring->put, atomic_load_explicit(&ring->put, memory_order_relaxed) + 1U,
                          memory_order_release);
}

/** Takes a byte out; false when there is none.  The reader's. */
static inline bool epg_ring_take(epg_ring_t *ring, unsigned char *byte)
{
    if (epg_ring_count(ring) == 0U) {
        return false;
    }
    *byte = ring->bytes[ring->taken_at];
    ring->taken_at = ring->taken_at + 1U == ring->size ? 0U : ring->taken_at + 1U;
    atomic_store_explicit(&ring->taken, atomic_load_explicit(&ring->taken, memory_order_relaxed) + 1U,
                          memory_order_release);
    return true;
}

/** Takes out up to `size` bytes; returns how many.  The reader's. */
static inline size_t epg_ring_read(epg_ring_t *ring, void *data, size_t size)
{
    unsigned char *bytes = data;
    size_t count = 0;
    while (count < size && epg_ring_take(ring, &bytes[count])) {
        count++;
    }
    return count;
}

/** Puts in as many of `size` bytes as there is room for; returns how many.  The rest is not lost, but the caller's. */
static inline size_t epg_ring_write(epg_ring_t *ring, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    const size_t room = epg_ring_room(ring);
    const size_t count = size < room ? size : room;
    for (size_t i = 0; i < count; i++) {
        epg_ring_put(ring, bytes[i]);
    }
    return count;
}

#endif
