/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tables of a system, which the generator writes, and the main() of the program that simulates it.
 */
#ifndef EPG_SYSTEM_H
#define EPG_SYSTEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** A target.  The shared objects are in the folder of the program. */
typedef struct epg_system_target {
    const char *name;
    const char *unit;  /**< file name of the unit */
    const char *plant; /**< file name of the plant; NULL: none */
    uint64_t start_ns; /**< true time of the first tick */
    int32_t drift_ppb; /**< the clock runs fast by this many parts per 10^9 */
    bool in_plant;     /**< it acts on the plant of the system, or senses it */
} epg_system_target_t;

/** A connection: each message of a publication is sent to one receiver. */
typedef struct epg_system_connection {
    const char *name;    /**< "leader/pan_publisher -> follower/pan_subscriber"; the random numbers depend on it */
    size_t sender;       /**< index of a target */
    size_t publication;  /**< index of a publication of the sender */
    size_t receiver;     /**< index of a target */
    size_t subscription; /**< index of a subscription of the receiver */
    uint64_t delay_ns;   /**< shortest time of a message on its way */
    uint64_t jitter_ns;  /**< longest additional time */
    uint32_t loss_ppm;   /**< messages of 10^6 that are lost */
    bool reliable;       /**< a lost message is sent again, after twice the longest way */
} epg_system_connection_t;

/** A port of a plant, a double. */
typedef struct epg_system_port {
    const char *name;
    size_t offset; /**< in the structure of the plant's inputs or outputs */
} epg_system_port_t;

/** The plant of the whole system.  Its shared object is in the folder of the program. */
typedef struct epg_system_plant {
    const char *file; /**< file name of the shared object */
    uint64_t step_ns; /**< the step of the model is step_ns / divisor nanoseconds */
    uint64_t divisor;
    bool starts_by_step; /**< the first step, at time 0, computes the first outputs */
    size_t input_count;
    const epg_system_port_t *inputs;
    size_t output_count;
    const epg_system_port_t *outputs;
} epg_system_plant_t;

typedef struct epg_system {
    const char *name;
    const epg_system_plant_t *plant; /**< NULL: there is none */
    size_t target_count;
    const epg_system_target_t *targets;
    size_t connection_count;
    const epg_system_connection_t *connections;
} epg_system_t;

/** Body of main(): reads the options, simulates the system, writes files.  Returns the exit status. */
int epg_system_main(const epg_system_t *system, int argc, char **argv);

#endif
