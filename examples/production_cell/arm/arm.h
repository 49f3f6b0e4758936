/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An arm with a magnet: the extractor and the rotation robot.  It takes a block from one space, and puts it on a belt.
 *
 * The magnet holds without power; power releases.  The end stop is above the belt.  A switch at either end tells if the arm
 * is in a space, so that it knows this after a restart, too.  It homes by permission of the belt.
 */
#ifndef ARM_H
#define ARM_H

#include "axis.h"
#include "space.h"

typedef enum arm_state {
    ARM_IS_LOST, /**< it does not know its position, and waits for the belt's permission to home */
    ARM_HOMES,
    ARM_RELEASES,
    ARM_LEAVES_BELT,
    ARM_WAITS,
    ARM_TAKES,
    ARM_LEAVES_SOURCE,
    ARM_PUTS,
} arm_state_t;

typedef struct arm {
    double lease;  /**< parameters */
    double source; /**< position at which it takes blocks, m */
    double speed;  /**< m/s */
    axis_t axis;
    double time;
    double since; /**< time of the last change of the state, s */
    double asked; /**< time at which it began to wait for a space, s */
    arm_state_t state;
} arm_t;

typedef struct arm_inputs {
    double position; /**< m from the belt */
    bool is_over_belt;
    bool is_at_source;
    bool has_block;
    double source_stamp;
    double source_echo;
    double source_grant;
    double belt_stamp;
    double belt_echo;
    double belt_grant;
} arm_inputs_t;

typedef struct arm_outputs {
    double duty;
    bool release;
    double source_now;
    double source_heard;
    double source_state;
    double belt_now;
    double belt_heard;
    double belt_state;
} arm_outputs_t;

void arm_init(arm_t *arm, const arm_inputs_t *inputs, arm_outputs_t *outputs);
void arm_step(arm_t *arm, const arm_inputs_t *inputs, arm_outputs_t *outputs);

#endif
