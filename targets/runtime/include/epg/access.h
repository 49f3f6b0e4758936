/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Access of the user's program to setpoints, values and parameters, beside the communication side.
 *
 * The generated functions `<name>_set_...()` and `<name>_get_...()` call the functions below.  One context of the
 * program may call them: a thread, a task, or main().  It may run on either core, and at any priority below that of the
 * control side.  It must not call them while the target is being started or stopped.
 *
 * The exchanges of a control object have one writer and one reader each, and these are the communication side and the
 * control side.  An access therefore has exchanges of its own.  Its first call puts it into the list of the control
 * object; the cycle then uses it.  epg_control_start() empties this list, so that the next call begins with empty
 * exchanges.  No function waits.  A program that calls none of them contains neither an access nor this code.
 *
 *     static epg_value_access_t values = {...};
 *     if (epg_access_values(&values, &control)) { ... }      // `values.taken` is the newest cycle
 */
#ifndef EPG_ACCESS_H
#define EPG_ACCESS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/control.h"

/** Access to the setpoints.  The generator sets all members but `dropped`, and defines the arrays. */
typedef struct epg_setpoint_access {
    epg_access_t access;          /**< must be the first member */
    size_t count;                 /**< number of setpoints of the application */
    epg_exchange_t exchange;      /**< its value is `count` samples */
    epg_setpoint_sample_t *given; /**< program: `count` samples */
    epg_setpoint_sample_t *taken; /**< control side: `count` samples */
    uint32_t *counts;             /**< control side: for each of `count`, the number of its newest sample */
    atomic_uint *arrivals;  /**< for each of `count`, the number of samples; NULL: epg_application_t.arrived is NULL */
    unsigned int *informed; /**< communication side: `count` of these numbers, at its last turn */

    atomic_uint dropped; /**< written by the program: number of refused setpoints */
} epg_setpoint_access_t;

/** Access to the values of the newest cycle.  The generator sets all members but `any`. */
typedef struct epg_value_access {
    epg_access_t access;                             /**< must be the first member */
    epg_exchange_t exchange;                         /**< its value has the type of `*given` */
    void (*collect)(void *values, uint64_t time_ns); /**< control side: copies the values of the cycle at `time_ns` */
    void *given;                                     /**< control side: memory for one value of the exchange */
    void *taken;                                     /**< program: the newest value */
    bool any;                                        /**< program: `*taken` is valid */
} epg_value_access_t;

/** One requested value of a parameter. */
typedef struct epg_parameter_request {
    double value;
    uint32_t count; /**< number of requests so far */
} epg_parameter_request_t;

/** Access to parameters.  The generator sets the first block of members, and defines the arrays. */
typedef struct epg_parameter_access {
    epg_access_t access;            /**< must be the first member */
    epg_parameters_t *own;          /**< parameters that only the program changes; NULL: those of the application */
    epg_exchange_t requests;        /**< its value is one request for each parameter */
    epg_parameter_request_t *given; /**< program: a request for each parameter */
    epg_parameter_request_t *taken; /**< control side: the same */
    uint32_t *counts;               /**< control side: for each parameter, the number of its newest request */
    bool *which;                    /**< control side: for each parameter, true if it changes in this cycle */
    double *applied;                /**< control side: see `program` */
    epg_exchange_t program;         /**< a value for each parameter, and the number of requests of communication */
    double *values;                 /**< program: the newest value of `program` */
    epg_exchange_t communication;   /**< as `program`, for the communication side */
    double *informed;               /**< communication side: as `values` */

    epg_parameters_t *parameters; /**< `own`, or those of the application */
    bool any;                     /**< program: `values` are valid */
    bool published;               /**< control side: both exchanges have a value */
    unsigned int seen;            /**< control side: number of requests of the communication side in that value */
} epg_parameter_access_t;

/**
 * Delivers `value` to setpoint `index`, as if it had been received in a message now.  If a message for the same
 * setpoint takes effect in the same cycle, the one that was received later counts.  Returns false before the first
 * epg_control_start(), and if the value is not finite or outside of the setpoint's limits; such a value is dropped and
 * counted.
 */
bool epg_access_set(epg_setpoint_access_t *self, epg_control_t *control, size_t index, double value);

/**
 * Copies the values of the newest cycle in which the model was stepped to `*self->taken`.  All of them are from that
 * cycle, and finite.  Returns false before the end of such a cycle after the first call.
 */
bool epg_access_values(epg_value_access_t *self, epg_control_t *control);

/**
 * Requests to change parameter `index`; takes effect in the next cycle.  Requests before the same cycle take effect
 * together.  Of two for the same parameter the newer one counts; a change by the communication side is made after them.  Returns
 * false before the first epg_control_start(), and if the parameter cannot have the value (epg_parameters_can_be()).
 */
bool epg_access_set_parameter(epg_parameter_access_t *self, epg_control_t *control, size_t index, double value);

/** Copies the value of parameter `index` in the newest cycle.  Returns false before a cycle after the first call. */
bool epg_access_get_parameter(epg_parameter_access_t *self, epg_control_t *control, size_t index, double *value);

/**
 * Puts an access into the list of the control object, unless it is in it.  `clear` runs first; the cycle does not use
 * the access at that time.  Returns false before the first epg_control_start().
 */
bool epg_access_join(epg_access_t *self, epg_control_t *control,
                     void (*clear)(epg_access_t *self, const epg_application_t *application));

#endif
