/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Setpoints on the control side: newest sample, age, rate limit.  Internal to the control cycle.
 */
#ifndef EPG_SETPOINT_H
#define EPG_SETPOINT_H

#include "epg/control.h"

/** All setpoints to their initial values, all samples forgotten.  True if one has a timeout or a rate limit. */
bool epg_setpoints_start(const epg_application_t *application);

/** Takes over samples that have been read from the exchange; false when none of them is new. */
bool epg_setpoints_take(const epg_application_t *application);

/** Their ages count from `now_ns` on: the target is being enabled. */
void epg_setpoints_enable(const epg_application_t *application, uint64_t now_ns);

/**
 * Applies timeouts and rate limits: one control period's worth, however late the cycle is.  Returns the first
 * setpoint that is too old and whose action is to disable, NULL if there is none.  Changes nothing when no sample is
 * new and none has either of them.
 */
const epg_setpoint_t *epg_setpoints_update(const epg_application_t *application, uint64_t now_ns,
                                           epg_statistics_t *statistics);

#endif
