/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Frames between lockstep.c and its test: little-endian, without gaps; lockstep.py has the same.
 */
#ifndef FRAMES_H
#define FRAMES_H

#include <stdint.h>

enum { FRAME_SETPOINTS = 1, FRAME_START = 2 }; /* START: starts and enables the target before this tick */

/** One tick, as the robot has it. */
typedef struct __attribute__((packed)) frame_tick {
    uint64_t time_ns;
    uint64_t counts[2];
    uint8_t flags;
    double setpoints[2]; /**< only sent with FRAME_SETPOINTS */
} frame_tick_t;

/** The cycle of the tick: what the drivers were given, and the values of the model. */
typedef struct __attribute__((packed)) frame_cycle {
    uint32_t levels[2];
    uint8_t directions[4];
    uint32_t cycles, missed, overruns, fault; /**< EPG's statistics */
    double inputs[4];
    double outputs[6];
} frame_cycle_t;

#endif
