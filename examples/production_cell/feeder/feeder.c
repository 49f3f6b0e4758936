/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The controller of the feeder.
 */
#include "feeder.h"

static const double speed = 0.15;   /* m/s */
static const double stroke = 0.17;  /* m: a block is then at its place in the mould */
static const double outside = 0.08; /* m: the pusher is outside the mould, and further away than it can coast */

static int state_at_belt(feeder_state_t state)
{
    return state == FEEDER_WAITS ? SPACE_WANTED : SPACE_INSIDE;
}

static int state_at_mould(const feeder_t *feeder)
{
    switch (feeder->state) {
    case FEEDER_CLEARS:
    case FEEDER_WAITS:
        return SPACE_WANTED;
    case FEEDER_RETRACTS:
        return feeder->axis.position < outside ? SPACE_AWAY : SPACE_INSIDE;
    case FEEDER_HOMES:
    case FEEDER_PUSHES:
    default:
        return SPACE_INSIDE;
    }
}

static void answer(const feeder_t *feeder, const feeder_inputs_t *inputs, feeder_outputs_t *outputs)
{
    outputs->duty = axis_duty(&feeder->axis);
    outputs->belt_now = feeder->time;
    outputs->belt_heard = inputs->belt_stamp;
    outputs->belt_state = (double)state_at_belt(feeder->state);
    outputs->mould_now = feeder->time;
    outputs->mould_heard = inputs->mould_stamp;
    outputs->mould_state = (double)state_at_mould(feeder);
}

static void wait_for_spaces(feeder_t *feeder, feeder_state_t state)
{
    feeder->state = state;
    feeder->asked = feeder->time;
}

void feeder_init(feeder_t *feeder, const feeder_inputs_t *inputs, feeder_outputs_t *outputs)
{
    axis_start(&feeder->axis, inputs->position);
    answer(feeder, inputs, outputs);
}

void feeder_step(feeder_t *feeder, const feeder_inputs_t *inputs, feeder_outputs_t *outputs)
{
    const space_message_t belt = {inputs->belt_stamp, inputs->belt_echo, inputs->belt_grant};
    const space_message_t mould = {inputs->mould_stamp, inputs->mould_echo, inputs->mould_grant};
    axis_t *axis = &feeder->axis;
    axis_read(axis, inputs->position);
    feeder->time += AXIS_STEP;
    const bool may_push = space_is_leased(&belt, feeder->asked, feeder->time, feeder->lease) &&
                          space_is_leased(&mould, feeder->asked, feeder->time, feeder->lease);
    switch (feeder->state) {
    case FEEDER_HOMES:
        if (axis_home(axis)) {
            wait_for_spaces(feeder, inputs->barrier ? FEEDER_CLEARS : FEEDER_WAITS);
        }
        break;
    case FEEDER_CLEARS:
    case FEEDER_WAITS:
        axis_move(axis, 0.0, speed);
        feeder->state = may_push ? FEEDER_PUSHES : feeder->state;
        break;
    case FEEDER_PUSHES:
        if (may_push) {
            axis_move(axis, stroke, speed);
        } else {
            axis_run(axis, 0.0);
        }
        feeder->state = axis_is_at(axis, stroke) ? FEEDER_RETRACTS : FEEDER_PUSHES;
        break;
    case FEEDER_RETRACTS:
    default:
        axis_move(axis, 0.0, speed);
        if (axis_is_at(axis, 0.0)) {
            wait_for_spaces(feeder, FEEDER_WAITS);
        }
        break;
    }
    answer(feeder, inputs, outputs);
}
