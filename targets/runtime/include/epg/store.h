/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What a board keeps over a restart (epg_port_store_write()): its names, and parameters that were changed.
 *
 * Names belong to the board: they are there under a new firmware too, if it has a store.  Parameters belong to a model
 * and its generated values, which the store names: under another model they are refused.
 */
#ifndef EPG_STORE_H
#define EPG_STORE_H

#include <stdbool.h>
#include <stddef.h>

#include "epg/parameters.h"

/** Bytes of a stored name of a node, or of its namespace, with the terminating zero. */
#define EPG_STORE_NAME_SIZE 64

/** Bytes of a store that holds `count` changed values. */
#define EPG_STORE_SIZE(count) (16U + 2U * EPG_STORE_NAME_SIZE + 12U + 12U * (count))

typedef struct epg_store {
    /* The generator's. */
    unsigned char *bytes;         /**< EPG_STORE_SIZE(parameters->count); the communication side's */
    epg_parameters_t *parameters; /**< NULL: there are none */

    /* As stored, or as set since: epg/names.h. */
    char node[EPG_STORE_NAME_SIZE];       /**< "": as generated */
    char name_space[EPG_STORE_NAME_SIZE]; /**< "": as generated; "/": none */
} epg_store_t;

/**
 * Sets all parameters as generated, then those that are stored for this model, all or none of them, and names that are
 * stored.  Before the control loop and the communication start.
 */
void epg_store_load(epg_store_t *store);

/**
 * Stores names, and all parameters that are not as generated.  May take as long as epg_port_store_write() does: only
 * while outputs are safe.  Communication side.  Returns whether that could be done; `*values` is how many parameters
 * there were.
 */
bool epg_store_save(epg_store_t *store, size_t *values);

#endif
