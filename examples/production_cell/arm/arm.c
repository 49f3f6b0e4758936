/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The controller of an arm.
 */
#include "arm.h"

static const double put = 0.002;        /* m: a little before the end stop */
static const double clear = 0.03;       /* m from the put position: the magnet does not reach the block any more */
static const double longest_wait = 0.5; /* s for a block that the magnet should have taken or released */

static double middle(const arm_t *arm)
{
    return 0.45 * arm->source;
}

static int state_at_source(const arm_t *arm, const arm_inputs_t *inputs)
{
    switch (arm->state) {
    case ARM_IS_LOST:
    case ARM_HOMES:
        return inputs->is_at_source ? SPACE_INSIDE : SPACE_AWAY;
    case ARM_TAKES:
    case ARM_LEAVES_SOURCE:
        return SPACE_INSIDE;
    case ARM_WAITS:
        return inputs->has_block ? SPACE_AWAY : SPACE_WANTED;
    default:
        return SPACE_AWAY;
    }
}

static int state_at_belt(const arm_t *arm, const arm_inputs_t *inputs)
{
    switch (arm->state) {
    case ARM_IS_LOST:
        return inputs->is_over_belt ? SPACE_INSIDE : SPACE_WANTED;
    case ARM_HOMES:
    case ARM_RELEASES:
    case ARM_LEAVES_BELT:
    case ARM_PUTS:
        return SPACE_INSIDE;
    case ARM_WAITS:
        return inputs->has_block ? SPACE_WANTED : SPACE_AWAY;
    default:
        return SPACE_AWAY;
    }
}

static void answer(const arm_t *arm, const arm_inputs_t *inputs, arm_outputs_t *outputs)
{
    outputs->duty = axis_duty(&arm->axis);
    outputs->release = arm->state == ARM_RELEASES || (arm->state == ARM_LEAVES_BELT && arm->axis.position < clear);
    outputs->source_now = arm->time;
    outputs->source_heard = inputs->source_stamp;
    outputs->source_state = (double)state_at_source(arm, inputs);
    outputs->belt_now = arm->time;
    outputs->belt_heard = inputs->belt_stamp;
    outputs->belt_state = (double)state_at_belt(arm, inputs);
}

/** Moves to `target` if it may, and stops otherwise.  Returns true at the target. */
static bool go(arm_t *arm, double target, bool may)
{
    if (may) {
        axis_move(&arm->axis, target, arm->speed);
    } else {
        axis_run(&arm->axis, 0.0);
    }
    return axis_is_at(&arm->axis, target);
}

static arm_state_t next(arm_t *arm, const arm_inputs_t *inputs)
{
    const space_message_t source = {inputs->source_stamp, inputs->source_echo, inputs->source_grant};
    const space_message_t belt = {inputs->belt_stamp, inputs->belt_echo, inputs->belt_grant};
    const bool may_take = space_is_leased(&source, arm->asked, arm->time, arm->lease);
    const bool may_put = space_is_leased(&belt, arm->asked, arm->time, arm->lease);
    const double waited = arm->time - arm->since;
    switch (arm->state) {
    case ARM_IS_LOST:
        axis_run(&arm->axis, 0.0);
        return may_put ? ARM_HOMES : ARM_IS_LOST;
    case ARM_HOMES:
        if (!may_put) {
            axis_run(&arm->axis, 0.0);
            return ARM_HOMES;
        }
        return axis_home(&arm->axis) ? ARM_RELEASES : ARM_HOMES;
    case ARM_RELEASES:
        axis_move(&arm->axis, put, arm->speed);
        return waited > 0.1 && (!inputs->has_block || waited > longest_wait) ? ARM_LEAVES_BELT : ARM_RELEASES;
    case ARM_LEAVES_BELT:
        return go(arm, middle(arm), true) ? ARM_WAITS : ARM_LEAVES_BELT;
    case ARM_WAITS:
        axis_move(&arm->axis, middle(arm), arm->speed);
        if (inputs->has_block) {
            return may_put ? ARM_PUTS : ARM_WAITS;
        }
        return may_take ? ARM_TAKES : ARM_WAITS;
    case ARM_TAKES:
        if (!go(arm, arm->source, may_take)) {
            arm->since = arm->time;
            return ARM_TAKES;
        }
        return inputs->has_block || waited > longest_wait ? ARM_LEAVES_SOURCE : ARM_TAKES;
    case ARM_LEAVES_SOURCE:
        return go(arm, middle(arm), true) ? ARM_WAITS : ARM_LEAVES_SOURCE;
    case ARM_PUTS:
    default:
        return go(arm, put, may_put) ? ARM_RELEASES : ARM_PUTS;
    }
}

void arm_init(arm_t *arm, const arm_inputs_t *inputs, arm_outputs_t *outputs)
{
    axis_start(&arm->axis, inputs->position);
    answer(arm, inputs, outputs);
}

void arm_step(arm_t *arm, const arm_inputs_t *inputs, arm_outputs_t *outputs)
{
    axis_read(&arm->axis, inputs->position);
    arm->time += AXIS_STEP;
    const arm_state_t state = next(arm, inputs);
    if (state != arm->state) {
        arm->state = state;
        arm->since = arm->time;
        arm->asked = state == ARM_WAITS ? arm->time : arm->asked;
    }
    answer(arm, inputs, outputs);
}
