/**
 * @file
 * What rcl allocates for one connection.
 */
#include "micro_ros_memory.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/** Stands before each block; as large as the strictest alignment asks for. */
typedef union block {
    struct {
        union block *next;
        union block *before;
        size_t size;
    } link;
    max_align_t align;
} block_t;

static block_t *first;

static void *allocate(size_t size, void *state)
{
    (void)state;
    block_t *block = size <= SIZE_MAX - sizeof *block ? malloc(sizeof *block + size) : NULL;
    if (block == NULL) {
        return NULL;
    }
    block->link.next = first;
    block->link.before = NULL;
    block->link.size = size;
    if (first != NULL) {
        first->link.before = block;
    }
    first = block;
    return block + 1;
}

static void deallocate(void *pointer, void *state)
{
    (void)state;
    if (pointer == NULL) {
        return;
    }
    block_t *block = (block_t *)pointer - 1;
    if (block->link.before != NULL) {
        block->link.before->link.next = block->link.next;
    } else {
        first = block->link.next;
    }
    if (block->link.next != NULL) {
        block->link.next->link.before = block->link.before;
    }
    free(block);
}

static void *reallocate(void *pointer, size_t size, void *state)
{
    void *larger = allocate(size, state);
    if (larger != NULL && pointer != NULL) {
        const size_t old = ((block_t *)pointer - 1)->link.size;
        memcpy(larger, pointer, old < size ? old : size);
        deallocate(pointer, state);
    }
    return larger;
}

static void *allocate_zeros(size_t count, size_t size, void *state)
{
    void *zeros = size == 0 || count <= SIZE_MAX / size ? allocate(count * size, state) : NULL;
    if (zeros != NULL) {
        memset(zeros, 0, count * size);
    }
    return zeros;
}

rcutils_allocator_t epg_micro_ros_memory(void)
{
    return (rcutils_allocator_t){
        .allocate = allocate,
        .deallocate = deallocate,
        .reallocate = reallocate,
        .zero_allocate = allocate_zeros,
    };
}

void epg_micro_ros_memory_free(void)
{
    while (first != NULL) {
        deallocate(first + 1, NULL);
    }
}
