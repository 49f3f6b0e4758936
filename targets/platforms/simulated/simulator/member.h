/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A target of a system while it is simulated.
 */
#ifndef EPG_SYSTEM_MEMBER_H
#define EPG_SYSTEM_MEMBER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "epg/system.h"
#include "files/setpoints.h"
#include "files/trace.h"
#include "module.h"
#include "plant.h"
#include "stall.h"

typedef enum member_state {
    MEMBER_RUNS,
    MEMBER_HANGS,  /**< no cycles, no messages; the outputs keep their levels */
    MEMBER_IS_DEAD /**< the outputs have their safe levels */
} member_state_t;

typedef struct member {
    const epg_system_target_t *facts;
    member_state_t state;
    bool offline;      /**< its messages are lost, and those to it */
    uint32_t life;     /**< number of restarts */
    uint64_t stall_ns; /**< the next control cycle takes this time */
    stall_t *stall;    /**< the cycle that is stalled; on the heap, NULL: there was none */
    bool is_stalled;
    uint64_t tick;       /**< number of the tick of the present cycle */
    uint64_t begin_ns;   /**< true time at which it has begun */
    uint32_t missed;     /**< ticks before it that have had no cycle */
    uint64_t started_ns; /**< true time of the first tick of this life */
    const char *folder;  /* of the shared objects */
    module_t module;
    const epg_unit_t *unit;
    plant_t own_plant;
    plant_t *plant;    /**< its own one, or that of the system; NULL: it has none */
    double *monitored; /**< the newest monitoring values */
    double *published; /**< the values of the newest messages of publications on change */
    double *received;  /**< room for the values of a message */
    bool *announced;   /**< for each publication on change: a message was sent */
    epg_host_events_t events;
    epg_host_trace_t trace;
    FILE *file;
} member_t;

/**
 * Loads the target, and its own plant if it has one, and starts the target.  `plant` is the plant of the system; NULL:
 * there is none.  Returns false after a message.
 */
bool member_open(member_t *member, const epg_system_target_t *facts, const char *folder, plant_t *plant);

/** Ends a target at the true time `time_ns`, as a loss of its power does.  Its plant goes on. */
void member_die(member_t *member, uint64_t time_ns);

/**
 * Loads a new copy of the target and starts it at the true time `time_ns`.  A target that runs dies before.  Returns
 * false after a message.
 */
bool member_restart(member_t *member, uint64_t time_ns);

/** True time of tick `number` of this life.  Computed from the number alone, so that errors do not add up. */
uint64_t member_tick_ns(const member_t *member, uint64_t number);

/** The time of the target's own clock at the true time `time_ns`. */
uint64_t member_clock_ns(const member_t *member, uint64_t time_ns);

/** True time at which the target's clock shows `clock_ns`. */
uint64_t member_true_ns(const member_t *member, uint64_t clock_ns);

/**
 * Runs the control cycle of tick `number` at the true time `time_ns`, or begins it if it is stalled: it then goes on at
 * `time_ns` + `stall_ns`.  Returns false, with a message, if the target's own plant has diverged, or if memory is short.
 */
bool member_cycle(member_t *member, uint64_t number, uint64_t time_ns);

/** Ends a cycle that is stalled, at the true time `time_ns`. */
void member_resume(member_t *member, uint64_t time_ns);

/**
 * Returns the number of the next tick after a cycle that has ended at the true time `time_ns`: the newest one that is
 * due, or the one after the cycle's.  Keeps the number of ticks in between.
 */
uint64_t member_next_tick(member_t *member, uint64_t time_ns);

/** Frees everything. */
void member_close(member_t *member);

#endif
