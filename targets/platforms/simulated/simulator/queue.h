/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The events that wait for their time.
 */
#ifndef EPG_SYSTEM_QUEUE_H
#define EPG_SYSTEM_QUEUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Events at the same time happen in this order; events of one kind in the order of their targets and connections. */
typedef enum event_kind { EVENT_FAILURE, EVENT_OUTSIDE, EVENT_ARRIVAL, EVENT_CYCLE, EVENT_PUBLICATION } event_kind_t;

typedef struct event {
    uint64_t time_ns; /**< true time */
    event_kind_t kind;
    size_t place;    /**< index of the target, of the connection of a message, or of a failure */
    uint32_t life;   /**< the life of the target to which a cycle or a publication belongs */
    uint64_t number; /**< the number of the tick, the publication or the message */
    void *message;   /**< the bytes of a message, on the heap */
    size_t size;     /**< their number */
} event_t;

/** A binary heap.  Zero-initialised memory is an empty queue. */
typedef struct queue {
    event_t *events;
    size_t count;
    size_t capacity;
} queue_t;

/** Adds an event.  Returns false if memory is short. */
bool queue_add(queue_t *queue, const event_t *event);

/** Takes the next event.  Returns false if there is none. */
bool queue_take(queue_t *queue, event_t *event);

/** Frees the memory of the queue and of its messages. */
void queue_free(queue_t *queue);

#endif
