/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The events that wait for their time: a binary heap.
 */
#include "queue.h"

#include <stdlib.h>

static bool before(const event_t *one, const event_t *other)
{
    if (one->time_ns != other->time_ns) {
        return one->time_ns < other->time_ns;
    }
    if (one->kind != other->kind) {
        return one->kind < other->kind;
    }
    return one->place != other->place ? one->place < other->place : one->number < other->number;
}

static void swap(event_t *one, event_t *other)
{
    const event_t kept = *one;
    *one = *other;
    *other = kept;
}

bool queue_add(queue_t *queue, const event_t *event)
{
    if (queue->count == queue->capacity) {
        const size_t capacity = queue->capacity == 0 ? 64 : 2 * queue->capacity;
        event_t *events = realloc(queue->events, capacity * sizeof *events);
        if (events == NULL) {
            return false;
        }
        queue->events = events;
        queue->capacity = capacity;
    }
    size_t at = queue->count++;
    queue->events[at] = *event;
    while (at > 0 && before(&queue->events[at], &queue->events[(at - 1) / 2])) {
        swap(&queue->events[at], &queue->events[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    return true;
}

bool queue_take(queue_t *queue, event_t *event)
{
    if (queue->count == 0) {
        return false;
    }
    *event = queue->events[0];
    queue->events[0] = queue->events[--queue->count];
    size_t at = 0;
    for (;;) {
        const size_t left = 2 * at + 1;
        const size_t right = left + 1;
        size_t first = at;
        first = left < queue->count && before(&queue->events[left], &queue->events[first]) ? left : first;
        first = right < queue->count && before(&queue->events[right], &queue->events[first]) ? right : first;
        if (first == at) {
            return true;
        }
        swap(&queue->events[at], &queue->events[first]);
        at = first;
    }
}

void queue_free(queue_t *queue)
{
    for (size_t i = 0; i < queue->count; i++) {
        free(queue->events[i].message);
    }
    free(queue->events);
    *queue = (queue_t){0};
}
