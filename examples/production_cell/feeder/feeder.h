/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The feeder: it pushes a block from the end of the feeder belt into the mould.
 *
 * Its end stop is behind the belt, so that homing moves it away from the belt and out of the mould.  If a block is between
 * belt and mould after homing, the feeder pushes it into the mould before the belt may bring another one.
 */
#ifndef FEEDER_H
#define FEEDER_H

#include "axis.h"
#include "space.h"

typedef enum feeder_state {
    FEEDER_HOMES,
    FEEDER_CLEARS, /**< waits to push a block that is between belt and mould */
    FEEDER_WAITS,
    FEEDER_PUSHES,
    FEEDER_RETRACTS,
} feeder_state_t;

typedef struct feeder {
    double lease; /**< parameter */
    axis_t axis;
    double time;
    double asked; /**< time at which it began to wait for the spaces, s */
    feeder_state_t state;
} feeder_t;

typedef struct feeder_inputs {
    double position; /**< m */
    bool barrier;    /**< a block is between belt and mould */
    double belt_stamp;
    double belt_echo;
    double belt_grant;
    double mould_stamp;
    double mould_echo;
    double mould_grant;
} feeder_inputs_t;

typedef struct feeder_outputs {
    double duty;
    double belt_now;
    double belt_heard;
    double belt_state;
    double mould_now;
    double mould_heard;
    double mould_state;
} feeder_outputs_t;

void feeder_init(feeder_t *feeder, const feeder_inputs_t *inputs, feeder_outputs_t *outputs);
void feeder_step(feeder_t *feeder, const feeder_inputs_t *inputs, feeder_outputs_t *outputs);

#endif
