/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Plants whose outputs are no possible values.
 */
#ifndef EPG_HOST_DIVERGED_H
#define EPG_HOST_DIVERGED_H

#include <stdbool.h>
#include <stdint.h>

/** The largest value of a plant's output, in its unit.  A plant with a larger absolute value has diverged. */
#define EPG_HOST_PLANT_LARGEST 1e12

/** Returns true if `value`, an output of a plant, is not finite or too large. */
bool epg_host_has_diverged(double value);

/** Prints a message: `output` had the value `value` at `time_ns`.  `owner` is a target of a system; NULL: none. */
void epg_host_tell_diverged(const char *owner, const char *output, double value, uint64_t time_ns);

#endif
