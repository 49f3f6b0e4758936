/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The simulation of a system.
 */
#ifndef EPG_SYSTEM_SIMULATE_H
#define EPG_SYSTEM_SIMULATE_H

#include "member.h"
#include "queue.h"

/** The messages of a connection. */
typedef struct way {
    uint64_t sent;      /**< number of messages */
    uint64_t received;  /**< the number of the newest message that has arrived, from 1 on; 0: none has */
    uint64_t newest_ns; /**< latest arrival of a message that was sent */
} way_t;

typedef enum failure_kind {
    FAILURE_DIE,
    FAILURE_HANG,
    FAILURE_RESTART,
    FAILURE_STALL,
    FAILURE_OFFLINE,
    FAILURE_ONLINE
} failure_kind_t;

/** A failure of a target, or its end. */
typedef struct failure {
    uint64_t time_ns;
    size_t target;
    failure_kind_t kind;
    uint64_t duration_ns; /**< of a stall; 0 for others */
} failure_t;

typedef struct simulation {
    const epg_system_t *system;
    uint64_t end_ns; /**< no event happens at or after this time */
    uint64_t seed;
    plant_t plant; /**< of the system; closed if it has none */
    member_t *members;
    way_t *ways;
    failure_t *failures; /**< on the heap */
    size_t failure_count;
    queue_t queue;
    FILE *topics; /**< receives all published values; NULL: not written */
} simulation_t;

/** The index of the target whose name has `length` characters from `name` on; the number of targets if there is none. */
size_t simulation_target(const epg_system_t *system, const char *name, size_t length);

/** Runs from time 0 to the end.  Returns false after a message. */
bool simulate(simulation_t *simulation);

#endif
