/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Setpoints: their age and rate limit.
 */
#include "setpoint.h"

bool epg_setpoints_start(const epg_application_t *application)
{
    bool move = false;
    for (size_t i = 0; i < application->setpoint_count; i++) {
        const epg_setpoint_t *setpoint = &application->setpoints[i];
        application->samples[i] = (epg_setpoint_sample_t){0};
        application->received[i] = (epg_setpoint_sample_t){0};
        application->setpoint_states[i] = (epg_setpoint_state_t){
            .value = setpoint->initial, .target = setpoint->initial, .begins = setpoint->measured != NULL};
        move = move || setpoint->timeout_ns > 0 || setpoint->rate_limit > 0.0 || setpoint->fresh;
    }
    if (application->setpoint_exchange != NULL) {
        epg_exchange_clear(application->setpoint_exchange);
    }
    return move;
}

bool epg_setpoints_take(const epg_application_t *application)
{
    bool taken = false;
    for (size_t i = 0; i < application->setpoint_count; i++) {
        const epg_setpoint_sample_t *sample = &application->samples[i];
        epg_setpoint_state_t *state = &application->setpoint_states[i];
        if (sample->count != state->count) {
            state->count = sample->count;
            taken = epg_setpoint_put(state, sample) || taken;
        }
    }
    return taken;
}

/** Returns true if the newest sample is older than its timeout.  A value that was not received has no age. */
static bool too_old(const epg_setpoint_t *setpoint, const epg_setpoint_state_t *state, uint64_t now_ns)
{
    /* `fresh_ns` can be after `now_ns`: the sample was then received after the start of this cycle. */
    return setpoint->timeout_ns > 0 && state->received && now_ns > state->fresh_ns &&
           now_ns - state->fresh_ns > setpoint->timeout_ns;
}

/** Begins with `value`, without a rate limit.  The value has no age until a sample is received. */
static void begin_with(epg_setpoint_state_t *state, double value)
{
    state->value = value;
    state->target = value;
    state->received = false;
    state->timed_out = false;
}

void epg_setpoints_enable(const epg_application_t *application, uint64_t now_ns)
{
    for (size_t i = 0; i < application->setpoint_count; i++) {
        const epg_setpoint_t *setpoint = &application->setpoints[i];
        epg_setpoint_state_t *state = &application->setpoint_states[i];
        if (setpoint->fresh) {
            state->since_ns = now_ns;
            state->begins = true;
        } else if (setpoint->action == EPG_TIMEOUT_DISABLE && too_old(setpoint, state, now_ns)) {
            begin_with(state, setpoint->initial); /* the old value would disable the target again at once */
        }
    }
}

/** Begins with `initial` or the measured value.  A sample that has been received since the enabling stays the target. */
static void begin(const epg_setpoint_t *setpoint, epg_setpoint_state_t *state)
{
    const bool came = state->received && state->fresh_ns >= state->since_ns;
    const double target = state->target;
    state->begins = false;
    begin_with(state, setpoint->measured != NULL ? setpoint->measured() : setpoint->initial);
    if (came) {
        state->target = target;
        state->received = true;
    }
}

/** Returns `target`, or the nearest value to it that the rate limit allows in one control period. */
static double limited(const epg_application_t *application, const epg_setpoint_t *setpoint, double value, double target)
{
    const double largest = setpoint->rate_limit * ((double)application->period_ns * 1e-9);
    const double change = target - value;
    if (change > largest) {
        return value + largest;
    }
    if (change < -largest) {
        return value - largest;
    }
    return target;
}

const epg_setpoint_t *epg_setpoints_update(const epg_application_t *application, uint64_t now_ns,
                                           epg_statistics_t *statistics)
{
    const epg_setpoint_t *late = NULL;
    for (size_t i = 0; i < application->setpoint_count; i++) {
        const epg_setpoint_t *setpoint = &application->setpoints[i];
        epg_setpoint_state_t *state = &application->setpoint_states[i];
        if (state->begins) {
            begin(setpoint, state);
        }
        if (!state->timed_out && too_old(setpoint, state, now_ns)) {
            state->timed_out = true;
            statistics->setpoint_timeouts++;
            if (setpoint->action == EPG_TIMEOUT_ZERO) {
                state->target = 0.0;
            }
        }
        if (late == NULL && state->timed_out && setpoint->action == EPG_TIMEOUT_DISABLE) {
            late = setpoint;
        }
        state->value =
            setpoint->rate_limit > 0.0 ? limited(application, setpoint, state->value, state->target) : state->target;
    }
    return late;
}
