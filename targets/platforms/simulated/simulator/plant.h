/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A plant while it is simulated: of one target, or of the whole system.
 *
 * Step k of a plant is at k times its step, counted from time 0 of the run, in whole nanoseconds rounded up.  Its inputs
 * are held until its next step.  The plant is advanced to the present time before a target senses or actuates: steps
 * at the same time as a control cycle thus come before it.
 */
#ifndef EPG_SYSTEM_PLANT_H
#define EPG_SYSTEM_PLANT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "epg/system.h"
#include "epg/unit.h"
#include "module.h"

/** Zero-initialised memory is a closed plant. */
typedef struct plant {
    const epg_plant_module_t *model;
    module_t module;
    uint64_t step_ns; /**< the step is step_ns / divisor nanoseconds */
    uint64_t divisor;
    uint64_t next_ns; /**< time of the next step: next_ns + rest / divisor nanoseconds */
    uint64_t rest;
    const epg_system_plant_t *facts; /**< the ports that are recorded and checked; NULL: none */
    FILE *file;                      /**< receives a row for each step; NULL: not recorded */
    bool has_diverged;               /**< an output was not finite or too large, which was reported */
} plant_t;

/**
 * Loads the shared object `file` in `folder` into a closed plant, and sets the plant to its state at time 0.  Its step is `step_ns` /
 * `divisor` nanoseconds; with `starts_by_step` a step at time 0 computes its first outputs.  Returns false after a
 * message.
 */
bool plant_open(plant_t *plant, const char *folder, const char *file, uint64_t step_ns, uint64_t divisor,
                bool starts_by_step);

/** Writes the names of the ports of `plant->facts` and their present values to `file`, and a row after each step. */
void plant_record(plant_t *plant, FILE *file);

/** Writes the present outputs of `plant->facts` as members of a JSON object. */
void plant_write_outputs(const plant_t *plant, FILE *file);

/** Makes the steps that are due until `time_ns`.  A plant that has diverged makes none. */
void plant_advance(plant_t *plant, uint64_t time_ns);

/** Unloads the plant.  The file stays open. */
void plant_close(plant_t *plant);

#endif
