/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A control cycle that takes simulated time: it has a context of POSIX.
 */
#define _XOPEN_SOURCE 700 /* macOS has contexts for nothing else */

#include "stall.h"

#include <stdio.h>
#include <stdlib.h>
#include <ucontext.h>

#pragma GCC diagnostic ignored "-Wdeprecated-declarations" /* macOS recommends threads: a cycle needs only a stack */

enum { STACK_SIZE = 1024 * 1024 }; /* models have no deep recursion: targets have stacks of some KiB */

struct stall {
    ucontext_t simulation;
    ucontext_t cycle;
    void (*function)(void *context);
    void *context;
    uint64_t clock_ns;
    char stack[STACK_SIZE];
};

/** The stall that begins: functions of makecontext() have no pointers as arguments. */
static stall_t *beginning;

static void run(void)
{
    beginning->function(beginning->context);
}

bool stall_begin(stall_t **stall, void (*cycle)(void *context), void *context)
{
    if (*stall == NULL) {
        *stall = malloc(sizeof **stall);
    }
    beginning = *stall;
    if (beginning == NULL || getcontext(&beginning->cycle) != 0) {
        fputs("error: not enough memory for a cycle that is stalled\n", stderr);
        return false;
    }
    beginning->function = cycle;
    beginning->context = context;
    beginning->cycle.uc_stack.ss_sp = beginning->stack;
    beginning->cycle.uc_stack.ss_size = sizeof beginning->stack;
    beginning->cycle.uc_link = &beginning->simulation;
    makecontext(&beginning->cycle, run, 0);
    swapcontext(&beginning->simulation, &beginning->cycle);
    return true;
}

uint64_t stall_wait(void *stall)
{
    stall_t *self = stall;
    swapcontext(&self->cycle, &self->simulation);
    return self->clock_ns;
}

void stall_end(stall_t *stall, uint64_t clock_ns)
{
    stall->clock_ns = clock_ns;
    swapcontext(&stall->simulation, &stall->cycle);
}

void stall_free(stall_t *stall)
{
    free(stall);
}
