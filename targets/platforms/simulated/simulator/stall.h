/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A control cycle that takes simulated time.
 *
 * It has a stack of its own.  After it has sampled the sensors, it waits there until the simulation comes to the time at
 * which it goes on.  Other targets can be stalled at the same time.
 */
#ifndef EPG_SYSTEM_STALL_H
#define EPG_SYSTEM_STALL_H

#include <stdbool.h>
#include <stdint.h>

typedef struct stall stall_t;

/**
 * Runs `cycle(context)` until it calls stall_wait().  `*stall` is NULL at the first call, and is used again at later
 * ones: a cycle that still waits there is dropped.  Returns false, with a message, if memory is short.
 */
bool stall_begin(stall_t **stall, void (*cycle)(void *context), void *context);

/** Called by the cycle with its `stall_t`: waits.  Returns the `clock_ns` of stall_end(). */
uint64_t stall_wait(void *stall);

/** Lets the cycle go on to its end. */
void stall_end(stall_t *stall, uint64_t clock_ns);

/** Frees the memory; NULL is possible. */
void stall_free(stall_t *stall);

#endif
