/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The door of the mould, which owns the space in it: the feeder may be inside while the door is closed, the extractor
 * while it is open.
 *
 * The end stop is at the top, so that homing opens the door.  It waits until a lease of the feeder has ended.
 */
#ifndef DOOR_H
#define DOOR_H

#include "axis.h"
#include "space.h"

typedef struct door {
    double timeout; /**< parameters, s */
    double moulding;
    axis_t axis;
    double time;
    bool is_homed;
    space_owner_t feeder;
    space_owner_t extractor;
    double moulded; /**< time for which the block has been moulded, s */
} door_t;

typedef struct door_inputs {
    double position; /**< m from the open door downwards */
    bool barrier;    /**< a block is at its place in the mould */
    double feeder_stamp;
    double feeder_echo;
    double feeder_state;
    double extractor_stamp;
    double extractor_echo;
    double extractor_state;
} door_inputs_t;

typedef struct door_outputs {
    double duty;
    double feeder_now;
    double feeder_heard;
    double feeder_grant;
    double extractor_now;
    double extractor_heard;
    double extractor_grant;
} door_outputs_t;

void door_init(door_t *door, const door_inputs_t *inputs, door_outputs_t *outputs);
void door_step(door_t *door, const door_inputs_t *inputs, door_outputs_t *outputs);

#endif
