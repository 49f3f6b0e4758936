/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The changes of parameters that a stream tells, so that a recording contains each change with its cycle.
 *
 * Each row of a stream (epg/telemetry.h) tells at most one change: the parameter, its value, and the cycle in which it
 * acted.  Changes that act in the same cycle are told by the rows that follow.  After each initialisation of the model,
 * all values that differ from the generated ones are told again, so that a recording needs no earlier rows.
 *
 * Cycles are counted from the initialisation of the model, which has the number 1.  Only the control side uses the log.
 */
#ifndef EPG_PARAMETER_LOG_H
#define EPG_PARAMETER_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct epg_parameters;

/** The log.  The generator sets `acted`; all other members are zero at the start. */
typedef struct epg_parameter_log {
    uint32_t
        *acted;    /**< for each parameter, the cycle of its change that is not yet told; 0: none.  NULL: no streams */
    uint32_t now;  /**< number of the present cycle while a stream runs; 0: changes are not told */
    size_t untold; /**< number of changes that are not yet told */
    size_t next;   /**< the parameter at which the next search begins */
    bool lost;     /**< another change replaced a change that was not yet told */
} epg_parameter_log_t;

/** One told change. */
typedef struct epg_parameter_told {
    bool lost;      /**< changes were lost: the recording is not complete */
    bool any;       /**< there is a change */
    size_t index;   /**< of the parameter */
    double value;   /**< its value after the change */
    uint32_t acted; /**< the cycle of the change */
} epg_parameter_told_t;

/** Empties the log, at the start of a stream. */
void epg_parameter_log_clear(struct epg_parameters *parameters);

/** Adds the change of parameter `index` that acts in the present cycle. */
void epg_parameter_log_add(struct epg_parameters *parameters, size_t index);

/** Adds all values that differ from the generated ones.  The model was initialised in the present cycle. */
void epg_parameter_log_restart(struct epg_parameters *parameters);

/** Takes the next change out of the log. */
epg_parameter_told_t epg_parameter_log_tell(struct epg_parameters *parameters);

#endif
