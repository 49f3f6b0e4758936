/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The controller of the door.
 */
#include "door.h"

static const double speed = 0.15; /* m/s */
static const double open = 0.004; /* m: a little below the end stop */
static const double closed = 0.08;

static void answer(const door_t *door, const door_inputs_t *inputs, door_outputs_t *outputs)
{
    outputs->duty = axis_duty(&door->axis);
    outputs->feeder_now = door->time;
    outputs->feeder_heard = inputs->feeder_stamp;
    outputs->feeder_grant = door->feeder.grants ? 1.0 : 0.0;
    outputs->extractor_now = door->time;
    outputs->extractor_heard = inputs->extractor_stamp;
    outputs->extractor_grant = door->extractor.grants ? 1.0 : 0.0;
}

void door_init(door_t *door, const door_inputs_t *inputs, door_outputs_t *outputs)
{
    axis_start(&door->axis, inputs->position);
    answer(door, inputs, outputs);
}

void door_step(door_t *door, const door_inputs_t *inputs, door_outputs_t *outputs)
{
    const space_message_t feeder = {inputs->feeder_stamp, inputs->feeder_echo, inputs->feeder_state};
    const space_message_t extractor = {inputs->extractor_stamp, inputs->extractor_echo, inputs->extractor_state};
    axis_t *axis = &door->axis;
    axis_read(axis, inputs->position);
    door->time += AXIS_STEP;
    if (!door->is_homed) {
        door->is_homed = door->time > door->timeout && axis_home(axis);
        answer(door, inputs, outputs);
        return;
    }

    const bool feeder_is_out = space_is_free(&door->feeder, &feeder, door->time, door->timeout);
    const bool extractor_is_out = space_is_free(&door->extractor, &extractor, door->time, door->timeout);
    const bool moulds = inputs->barrier && axis_is_at(axis, closed) && feeder_is_out;
    door->moulded = !inputs->barrier ? 0.0 : moulds ? door->moulded + AXIS_STEP : door->moulded;
    const bool is_ready = inputs->barrier && door->moulded > door->moulding && feeder_is_out;
    if (is_ready) {
        axis_move(axis, open, speed);
    } else if (extractor_is_out) {
        axis_move(axis, closed, speed);
    } else {
        axis_run(axis, 0.0);
    }

    const bool is_called = (space_is(&feeder, SPACE_WANTED) && !inputs->barrier) || space_is(&feeder, SPACE_INSIDE);
    const bool may_take = (space_is(&extractor, SPACE_WANTED) && is_ready) || space_is(&extractor, SPACE_INSIDE);
    space_grant(&door->feeder, axis_is_at(axis, closed) && extractor_is_out && is_called, door->time);
    space_grant(&door->extractor, axis_is_at(axis, open) && may_take, door->time);
    answer(door, inputs, outputs);
}
