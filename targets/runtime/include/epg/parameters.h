/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Model parameters that change while the model runs.
 *
 * The communication side hands over a few changes at a time; the control side makes all of them between two model
 * steps.  A change outlives disabling and enabling, which initialise the model with the values it was generated with:
 * what was changed is changed again then, and what the model computed from its parameters while it was initialised
 * (initial values of states) is as generated.
 *
 * Changed values can be stored (epg/store.h) and are back after the next start, unless model or generated values have
 * changed since: the store names the model it belongs to.
 */
#ifndef EPG_PARAMETERS_H
#define EPG_PARAMETERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/handover.h"

/** Most changes of one control cycle: each may make the model compute what it derives from its parameters. */
enum { EPG_PARAMETER_CHANGES = 8 };

typedef struct epg_parameter {
    const char *name; /**< as in the model: "PID1\kp" */
    const char *unit; /**< "" when the model states none */
    double value;     /**< as generated */
} epg_parameter_t;

typedef struct epg_parameter_change {
    size_t index;
    double value;
} epg_parameter_change_t;

/** What became of stored values. */
typedef enum epg_parameters_stored {
    EPG_STORED_NOTHING,   /**< nothing was stored, or it is damaged */
    EPG_STORED_FOR_OTHER, /**< it belongs to another model: refused */
    EPG_STORED_LOADED
} epg_parameters_stored_t;

/** The parameters of one model.  The generator sets the first block of members; the arrays are its own. */
typedef struct epg_parameters {
    size_t count;
    const epg_parameter_t *table;
    uint64_t model;                          /**< identifies the model and its generated values */
    void (*set)(size_t index, double value); /**< control side: changes the model, which is initialised */
    double *values;                          /**< `count`: the communication side's, as changed last */
    double *applied;                         /**< `count`: the control side's */
    bool *changed;                           /**< `count`: the control side's: which of `applied` mean something */

    epg_parameters_stored_t stored;
    epg_handover_t handover; /**< of what follows */
    epg_parameter_change_t changes[EPG_PARAMETER_CHANGES];
    size_t change_count;
} epg_parameters_t;

/* Control side ----------------------------------------------------------------------------------------------- */

/** Makes the changes that have been handed over; `running`: the model is initialised. */
void epg_parameters_apply(epg_parameters_t *parameters, bool running);

/** After the model has been initialised: makes all changes so far again. */
void epg_parameters_restore(const epg_parameters_t *parameters);

/* Communication side ----------------------------------------------------------------------------------------- */

/** True when the control side has made all changes that were handed over. */
bool epg_parameters_idle(epg_parameters_t *parameters);

/**
 * Hands over `count` (1 ... EPG_PARAMETER_CHANGES) changes, which act in the same cycle.  False, and nothing happens,
 * if one names no parameter or is not finite, if there are too many, or while changes handed over before wait for
 * the control side.
 */
bool epg_parameters_change(epg_parameters_t *parameters, const epg_parameter_change_t *changes, size_t count);

/** Value of parameter `index`, which exists, as changed last. */
double epg_parameters_value(const epg_parameters_t *parameters, size_t index);

#endif
