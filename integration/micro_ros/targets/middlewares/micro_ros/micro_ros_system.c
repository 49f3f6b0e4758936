/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services of an operating system that libmicroros needs: memory and, on a microcontroller, the time.
 *
 * The memory is a row of blocks, each with its size before it.  An allocation takes the first free block that is large
 * enough.  This simple search is fast enough: a connection has a few dozen blocks, and nothing is allocated while it is
 * up.
 */
#include "micro_ros_system.h"

#include <stdint.h>
#include <string.h>

#include "epg/port.h"

/** The header before each block.  Its size is a multiple of the strictest alignment. */
typedef union block {
    struct {
        size_t size; /* bytes after this header */
        bool used;
    } is;
    max_align_t align;
} block_t;

static struct {
    char *begin;
    char *end;
} arena;

static block_t *behind(block_t *block)
{
    return (block_t *)(void *)((char *)(block + 1) + block->is.size);
}

static bool is_last(block_t *block)
{
    return (char *)behind(block) == arena.end;
}

/** Joins `block` with the free blocks after it. */
static void join_free(block_t *block)
{
    while (!is_last(block) && !behind(block)->is.used) {
        block->is.size += sizeof *block + behind(block)->is.size;
    }
}

/** Cuts `block` to `size` bytes.  The rest becomes a free block after it. */
static void split(block_t *block, size_t size)
{
    if (block->is.size - size > sizeof *block) {
        const size_t rest = block->is.size - size - sizeof *block;
        block->is.size = size;
        behind(block)->is.size = rest;
        behind(block)->is.used = false;
    }
}

static void *allocate(size_t size, void *state)
{
    (void)state;
    if (arena.begin == NULL || size > SIZE_MAX - sizeof(block_t)) {
        return NULL;
    }
    size = (size + sizeof(block_t) - 1U) / sizeof(block_t) * sizeof(block_t);
    for (block_t *block = (block_t *)(void *)arena.begin;; block = behind(block)) {
        if (!block->is.used) {
            join_free(block);
            if (block->is.size >= size) {
                split(block, size);
                block->is.used = true;
                return block + 1;
            }
        }
        if (is_last(block)) {
            return NULL;
        }
    }
}

static void deallocate(void *pointer, void *state)
{
    (void)state;
    if (pointer != NULL) {
        ((block_t *)pointer - 1)->is.used = false;
    }
}

static void *reallocate(void *pointer, size_t size, void *state)
{
    void *larger = allocate(size, state);
    if (larger != NULL && pointer != NULL) {
        const size_t old = ((block_t *)pointer - 1)->is.size;
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
    if (arena.begin == NULL) {
        return;
    }
    block_t *all = (block_t *)(void *)arena.begin;
    all->is.size = (size_t)(arena.end - arena.begin) - sizeof *all;
    all->is.used = false;
}

bool epg_micro_ros_memory_start(void *bytes, size_t size)
{
    arena.begin = bytes;
    arena.end = arena.begin + size / sizeof(block_t) * sizeof(block_t);
    epg_micro_ros_memory_free();
#ifdef EPG_MICRO_ROS_DEFAULT_ALLOCATOR
    /* Some functions of rcl use its default allocator, whatever allocator they are given. */
    rcutils_allocator_t ours = epg_micro_ros_memory();
    return rcutils_set_default_allocator(&ours);
#else
    return true;
#endif
}

#ifdef EPG_MICRO_ROS_CLOCK

#include <time.h>

int clock_gettime(clockid_t clock, struct timespec *time);

/**
 * Returns the board time for every clock.  C libraries for microcontrollers lack this function.  The symbol is weak, so
 * that a user's function replaces it.
 */
__attribute__((weak)) int clock_gettime(clockid_t clock, struct timespec *time)
{
    (void)clock;
    const uint64_t now_ns = epg_port_time_ns();
    time->tv_sec = (time_t)(now_ns / 1000000000U);
    time->tv_nsec = (long)(now_ns % 1000000000U);
    return 0;
}

#endif
