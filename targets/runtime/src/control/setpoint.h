/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Setpoints on the control side: newest sample, age, rate limit.  Internal to the control cycle.
 */
#ifndef EPG_SETPOINT_H
#define EPG_SETPOINT_H

#include "epg/control.h"

/**
 * Sets all setpoints to their initial values and drops all samples.  Returns true if values can change without a new
 * sample: a setpoint has a timeout or a rate limit, or must be fresh.
 */
bool epg_setpoints_start(const epg_application_t *application);

/** Makes `sample` the newest sample of a setpoint.  Returns false if it was received too early to act. */
static inline bool epg_setpoint_put(epg_setpoint_state_t *state, const epg_setpoint_sample_t *sample)
{
    if (sample->received_ns < state->since_ns) {
        return false;
    }
    state->target = sample->value;
    state->fresh_ns = sample->received_ns;
    state->received = true;
    state->timed_out = false;
    return true;
}

/** Takes the samples that were read from the exchange.  Returns false if none of them is new. */
bool epg_setpoints_take(const epg_application_t *application);

/**
 * Makes fresh setpoints begin again, and those begin with `initial` whose sender is gone and must not act.  Must be called
 * in the cycle that enables the target, before epg_setpoints_update(); `now_ns` is the beginning of that cycle.
 */
void epg_setpoints_enable(const epg_application_t *application, uint64_t now_ns);

/**
 * Applies timeouts and rate limits.  A value changes by at most one control period's rate limit, however late the cycle
 * is.  Returns the first setpoint that is too old and whose action is to disable; NULL if there is none.  Must be called
 * after the sensors were sampled.
 *
 * The call has no effect, and can be omitted, if no sample is new and epg_setpoints_start() has returned false.
 */
const epg_setpoint_t *epg_setpoints_update(const epg_application_t *application, uint64_t now_ns,
                                           epg_statistics_t *statistics);

#endif
