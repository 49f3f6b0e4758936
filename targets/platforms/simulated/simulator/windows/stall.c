/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A control cycle that takes simulated time: it is a fiber of Windows.
 */
#include "stall.h"

#include <stdio.h>
#include <stdlib.h>

#include <windows.h>

enum { STACK_SIZE = 1024 * 1024 }; /* as on other systems */

struct stall {
    void *fiber;
    void (*function)(void *context);
    void *context;
    uint64_t clock_ns;
};

/** The fiber of the simulation. */
static void *simulation;

static void CALLBACK run(void *stall)
{
    const stall_t *self = stall;
    self->function(self->context);
    SwitchToFiber(simulation); /* a fiber that returns ends its thread */
}

static bool make_fiber(stall_t *stall)
{
    if (stall == NULL) {
        return false;
    }
    if (stall->fiber != NULL) {
        DeleteFiber(stall->fiber);
    }
    if (simulation == NULL) {
        simulation = ConvertThreadToFiber(NULL);
    }
    stall->fiber = simulation == NULL ? NULL : CreateFiber(STACK_SIZE, run, stall);
    return stall->fiber != NULL;
}

bool stall_begin(stall_t **stall, void (*cycle)(void *context), void *context)
{
    if (*stall == NULL) {
        *stall = calloc(1, sizeof **stall);
    }
    if (!make_fiber(*stall)) {
        fputs("error: not enough memory for a cycle that is stalled\n", stderr);
        return false;
    }
    (*stall)->function = cycle;
    (*stall)->context = context;
    SwitchToFiber((*stall)->fiber);
    return true;
}

uint64_t stall_wait(void *stall)
{
    const stall_t *self = stall;
    SwitchToFiber(simulation);
    return self->clock_ns;
}

void stall_end(stall_t *stall, uint64_t clock_ns)
{
    stall->clock_ns = clock_ns;
    SwitchToFiber(stall->fiber);
}

void stall_free(stall_t *stall)
{
    if (stall != NULL && stall->fiber != NULL) {
        DeleteFiber(stall->fiber);
    }
    free(stall);
}
