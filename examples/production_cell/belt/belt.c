/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The controller of a belt.
 */
#include "belt.h"

static const double speed = 0.15;  /* m/s */
static const double press = 0.015; /* m: from the light barrier to the fence */
static const double length = 0.65; /* m: after this way without a block at the start, the belt is empty */

static void answer(const belt_t *belt, const belt_inputs_t *inputs, belt_outputs_t *outputs)
{
    outputs->duty = axis_duty(&belt->axis);
    outputs->start_now = belt->time;
    outputs->start_heard = inputs->start_stamp;
    outputs->start_grant = belt->start.grants ? 1.0 : 0.0;
    outputs->end_now = belt->time;
    outputs->end_heard = inputs->end_stamp;
    outputs->end_grant = belt->end.grants ? 1.0 : 0.0;
}

void belt_init(belt_t *belt, const belt_inputs_t *inputs, belt_outputs_t *outputs)
{
    axis_start(&belt->axis, inputs->position);
    answer(belt, inputs, outputs);
}

void belt_step(belt_t *belt, const belt_inputs_t *inputs, belt_outputs_t *outputs)
{
    const space_message_t start = {inputs->start_stamp, inputs->start_echo, inputs->start_state};
    const space_message_t end = {inputs->end_stamp, inputs->end_echo, inputs->end_state};
    const double before = belt->axis.position;
    axis_read(&belt->axis, inputs->position);
    const double way = belt->axis.position - before;
    belt->time += AXIS_STEP;
    belt->after_start = inputs->barrier_start ? 0.0 : belt->after_start + way;
    belt->pressed = inputs->barrier_end ? belt->pressed + way : 0.0;

    const bool is_served = belt->pressed > press; /* a block is at the end, against the fence */
    const bool is_empty = belt->after_start > length && !inputs->barrier_end;
    const bool is_asked = !inputs->barrier_start && space_is(&start, SPACE_WANTED);
    const bool is_alone = space_is_free(&belt->start, &start, belt->time, belt->timeout) &&
                          space_is_free(&belt->end, &end, belt->time, belt->timeout);
    const bool runs = is_alone && !is_served && !is_empty && !is_asked;
    axis_run(&belt->axis, runs ? speed : 0.0);

    const bool rests = !runs && axis_is_still(&belt->axis);
    const bool at_end = space_is(&end, SPACE_INSIDE) || (is_served && space_is(&end, SPACE_WANTED));
    space_grant(&belt->start, rests && (is_asked || space_is(&start, SPACE_INSIDE)), belt->time);
    space_grant(&belt->end, rests && at_end, belt->time);
    answer(belt, inputs, outputs);
}
