/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A belt: an arm puts blocks on its start, and its guest at the end takes them.
 *
 * The belt needs no memory of its blocks: it runs until one is at the end.  After a restart it goes on where it is.  The
 * light barrier at the start sees the place of a block and a gap behind it.
 */
#ifndef BELT_H
#define BELT_H

#include "axis.h"
#include "space.h"

typedef struct belt {
    double timeout; /**< parameter, s */
    axis_t axis;
    double time;
    space_owner_t start; /**< the space in which the arm puts blocks */
    space_owner_t end;   /**< the space from which blocks are taken */
    double after_start;  /**< way since a block was last at the start, m */
    double pressed;      /**< way since a block is at the end, m */
} belt_t;

typedef struct belt_inputs {
    double position; /**< m */
    bool barrier_start;
    bool barrier_end;
    double start_stamp;
    double start_echo;
    double start_state;
    double end_stamp;
    double end_echo;
    double end_state;
} belt_inputs_t;

typedef struct belt_outputs {
    double duty;
    double start_now;
    double start_heard;
    double start_grant;
    double end_now;
    double end_heard;
    double end_grant;
} belt_outputs_t;

void belt_init(belt_t *belt, const belt_inputs_t *inputs, belt_outputs_t *outputs);
void belt_step(belt_t *belt, const belt_inputs_t *inputs, belt_outputs_t *outputs);

#endif
