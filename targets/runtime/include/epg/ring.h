/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A ring of bytes between an interrupt handler and the communication side.
 *
 * One side, the writer, puts bytes in; the other side, the reader, takes them out in the same order.  Neither waits.
 *
 * `put` and `taken` count bytes modulo 2^32, and only one side writes each of them.  Loads and stores of single words
 * are therefore sufficient: the reader never reads beyond `put`, and the writer never overwrites a byte that the reader
 * has not yet taken.
 */
#ifndef EPG_RING_H
#define EPG_RING_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct epg_ring {
    unsigned char *bytes;
    uint32_t size;     /**< number of `bytes`, at most 2^31 */
    atomic_uint put;   /**< number of bytes ever put in; written by the writer */
    atomic_uint taken; /**< number of bytes ever taken out; written by the reader */
    uint32_t put_at;   /**< index of the next byte to write; belongs to the writer */
    uint32_t taken_at; /**< index of the next byte to read; belongs to the reader */
    atomic_uint lost;  /**< number of bytes that found no room; written by the writer */
} epg_ring_t;

/** Returns the number of bytes in the ring.  For both sides. */
static inline uint32_t epg_ring_count(const epg_ring_t *ring)
{
    return (uint32_t)(atomic_load_explicit(&ring->put, memory_order_acquire) -
                      atomic_load_explicit(&ring->taken, memory_order_acquire));
}

/** Returns the number of bytes for which there is room.  For both sides. */
static inline uint32_t epg_ring_room(const epg_ring_t *ring)
{
    return ring->size - epg_ring_count(ring);
}

/** Puts a byte in, or counts it as lost if there is no room.  For the writer. */
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

/** Takes a byte out.  Returns false if the ring is empty.  For the reader. */
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

/** Takes out up to `size` bytes and returns their number.  For the reader. */
static inline size_t epg_ring_read(epg_ring_t *ring, void *data, size_t size)
{
    unsigned char *bytes = data;
    size_t count = 0;
    while (count < size && epg_ring_take(ring, &bytes[count])) {
        count++;
    }
    return count;
}

/**
 * Puts in as many of `size` bytes as there is room for, and returns their number.  The others do not count as lost: the
 * caller keeps them.  For the writer.
 */
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
