/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The store: data that a board keeps over a restart, in non-volatile memory (epg_port_store_write()).
 *
 * It holds the names of the node (epg/names.h) and changed parameters (epg/parameters.h).  Names belong to the board: a
 * new firmware uses them, too, if it has a store.  Parameters belong to a model with its generated values, which the
 * store identifies; another model refuses them.
 */
#ifndef EPG_STORE_H
#define EPG_STORE_H

#include <stdbool.h>
#include <stddef.h>

#include "epg/parameters.h"

/** Bytes of a stored node name or namespace, with the terminating zero. */
#define EPG_STORE_NAME_SIZE 64

/** Bytes of a store with `count` changed parameters. */
#define EPG_STORE_SIZE(count) (16U + 2U * EPG_STORE_NAME_SIZE + 12U + 12U * (count))

typedef struct epg_store {
    /* The generator sets these members. */
    unsigned char *bytes;         /**< EPG_STORE_SIZE(parameters->count) bytes; they belong to the communication side */
    epg_parameters_t *parameters; /**< NULL: the target has no changeable parameters */

    /* The names that were stored, or that epg/names.h has set since. */
    char node[EPG_STORE_NAME_SIZE];       /**< "": the generated name */
    char name_space[EPG_STORE_NAME_SIZE]; /**< "": the generated namespace; "/": no namespace */
} epg_store_t;

/**
 * Loads the stored names, and the parameters if they belong to this model.  A parameter that was not stored, or that
 * cannot have the stored value because its limits are new, has its generated value.  Must be called before the control
 * loop and the communication start.
 */
void epg_store_load(epg_store_t *store);

/**
 * Returns the name of the refused parameter `index`, counted from 0, of the result EPG_STORED_PARTLY; NULL: there are no
 * more.  They are known until epg_store_save().
 */
const char *epg_store_refused(const epg_store_t *store, size_t index);

/**
 * Stores the names, and all parameters that differ from their generated values.  Returns NULL, or why that failed;
 * `*values` is the number of these parameters.  May take as long as epg_port_store_write(), and must therefore be
 * called only while the outputs are safe.  Communication side.
 */
const char *epg_store_save(epg_store_t *store, size_t *values);

#endif
