/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Model parameters that can be changed while the model runs.
 *
 * The communication side requests changes of any number of parameters.  The control side makes all changes of one
 * request between two model steps, and then lets the model compute the values that it derives from parameters, once.
 * In such a cycle it looks at each parameter of the model, so the time for that is bounded by their number.
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
#include "epg/parameter_log.h"

typedef struct epg_parameter {
    const char *name; /**< as in the model: "PID1\kp" */
    const char *unit; /**< "" if the model has none */
    double value;     /**< generated value */
} epg_parameter_t;

/** The limits of a value, which are possible values themselves. */
typedef struct epg_parameter_limits {
    double minimum; /**< -INFINITY: there is no limit */
    double maximum;
} epg_parameter_limits_t;

typedef struct epg_parameter_change {
    size_t index;
    double value;
} epg_parameter_change_t;

/** The result of loading stored values, or of storing them since. */
typedef enum epg_parameters_stored {
    EPG_STORED_NOTHING,   /**< nothing was stored */
    EPG_STORED_DAMAGED,   /**< the store cannot be read, and no value was loaded */
    EPG_STORED_FOR_OTHER, /**< the stored values belong to another model and were refused */
    EPG_STORED_PARTLY,    /**< values that a parameter cannot have were refused (epg_store_refused()), others loaded */
    EPG_STORED_LOADED,
    EPG_STORED_SAVED /**< values were stored since the start */
} epg_parameters_stored_t;

/** Whether a change of a parameter has been told (epg/parameter_services.h). */
typedef enum epg_parameter_news {
    EPG_PARAMETER_TOLD,   /**< there is nothing new */
    EPG_PARAMETER_NEW,    /**< it has changed since */
    EPG_PARAMETER_TELLING /**< its change is in the last message */
} epg_parameter_news_t;

/** The parameters of one model.  The generator sets the first block of members, and defines the arrays. */
typedef struct epg_parameters {
    size_t count;
    const epg_parameter_t *table;
    const epg_parameter_limits_t *limits; /**< `count` limits; NULL: no parameter has limits */
    uint64_t model;                       /**< identifies the model and its generated values */
    /** Control side: changes the parameters of the initialised model for which `which` is true. */
    void (*set)(const double *values, const bool *which);
    double *values;  /**< communication side: `count` values, as requested last; given away with `wanted` */
    bool *wanted;    /**< for each of `count`, true if the control side must change it; see `handover` */
    double *applied; /**< control side: `count` values, as applied */
    bool *changed;   /**< control side: for each of `count`, true if `applied` is valid */
    uint8_t *news;   /**< communication side: for each of `count`, an epg_parameter_news_t; NULL: nobody is told */

    epg_parameters_stored_t stored;
    epg_handover_t handover; /**< of `values` and `wanted` */
    epg_parameter_log_t log; /**< control side */
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
 * Requests `count` changes, which take effect in the same cycle.  Returns false, and changes nothing, if a parameter
 * cannot have the value (epg_parameters_can_be()), if `count` is 0, or while the changes of the last request are not
 * yet made.
 */
bool epg_parameters_change(epg_parameters_t *parameters, const epg_parameter_change_t *changes, size_t count);

/**
 * Returns true if there is a parameter `index`, and if it can have this value: a finite one within its limits.
 */
bool epg_parameters_can_be(const epg_parameters_t *parameters, size_t index, double value);

/**
 * Prepares one change of a request, which epg_parameters_request() then makes.  The parameter must be able to have the
 * value.  Only while epg_parameters_idle().
 */
void epg_parameters_prepare(epg_parameters_t *parameters, size_t index, double value);

/** Requests all prepared changes.  They take effect in the same cycle.  Only while epg_parameters_idle(). */
void epg_parameters_request(epg_parameters_t *parameters);

/** Returns the value of parameter `index` as requested last.  The parameter must exist. */
double epg_parameters_value(const epg_parameters_t *parameters, size_t index);

#endif
