/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Model parameters that can be changed while the model runs.
 *
 * The communication side requests a few changes at a time.  The control side makes all changes of one request between
 * two model steps.
 *
 * Enabling a target initialises its model with the generated values.  The changes are then made again, so they stay.
 * Values that the model computes from parameters during its initialisation (initial values of states), however, follow
 * from the generated parameters.
 *
 * Changed values can be stored (epg/store.h).  They are loaded at the next start, unless the model or its generated
 * values have changed since: the store names the model to which it belongs.
 */
#ifndef EPG_PARAMETERS_H
#define EPG_PARAMETERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/handover.h"

/** Largest number of changes in one control cycle: a change can make the model recompute its derived values. */
enum { EPG_PARAMETER_CHANGES = 8 };

typedef struct epg_parameter {
    const char *name; /**< as in the model: "PID1\kp" */
    const char *unit; /**< "" if the model has none */
    double value;     /**< generated value */
} epg_parameter_t;

typedef struct epg_parameter_change {
    size_t index;
    double value;
} epg_parameter_change_t;

/** The result of loading stored values. */
typedef enum epg_parameters_stored {
    EPG_STORED_NOTHING,   /**< no values were stored, or they are damaged */
    EPG_STORED_FOR_OTHER, /**< the stored values belong to another model and were refused */
    EPG_STORED_LOADED
} epg_parameters_stored_t;

/** The parameters of one model.  The generator sets the first block of members, and defines the arrays. */
typedef struct epg_parameters {
    size_t count;
    const epg_parameter_t *table;
    uint64_t model;                          /**< identifies the model and its generated values */
    void (*set)(size_t index, double value); /**< control side: changes a parameter of the initialised model */
    double *values;                          /**< communication side: `count` values, as requested last */
    double *applied;                         /**< control side: `count` values, as applied */
    bool *changed;                           /**< control side: for each of `count`, true if `applied` is valid */

    epg_parameters_stored_t stored;
    epg_handover_t handover; /**< of the members below */
    epg_parameter_change_t changes[EPG_PARAMETER_CHANGES];
    size_t change_count;
} epg_parameters_t;

/* Control side ----------------------------------------------------------------------------------------------- */

/** Makes the requested changes.  `running` is true if the model is initialised. */
void epg_parameters_apply(epg_parameters_t *parameters, bool running);

/** Makes all changes so far again.  Must be called after the model was initialised. */
void epg_parameters_restore(const epg_parameters_t *parameters);

/* Communication side ----------------------------------------------------------------------------------------- */

/** Returns true if the control side has made all requested changes. */
bool epg_parameters_idle(epg_parameters_t *parameters);

/**
 * Requests `count` (1 ... EPG_PARAMETER_CHANGES) changes, which take effect in the same cycle.  Returns false, and
 * changes nothing, if an index is not a parameter's, if a value is not finite, if `count` is out of range, or while the
 * changes of the last request are not yet made.
 */
bool epg_parameters_change(epg_parameters_t *parameters, const epg_parameter_change_t *changes, size_t count);

/** Returns the value of parameter `index` as requested last.  The parameter must exist. */
double epg_parameters_value(const epg_parameters_t *parameters, size_t index);

#endif
