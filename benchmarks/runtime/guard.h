/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Motion guards of the JIWYs written by hand, on the host, on STM32 and on the Pico: stall and runaway.  The limits are
 * constants, and the compiler inlines the functions.
 */
#ifndef GUARD_H
#define GUARD_H

#include <stdbool.h>
#include <stdint.h>

/* Limits of the motion guards: angles in rad, times in cycles. */
#define STALL_DUTY 0.3
#define STALL_ANGLE 0.017453292519943295 /* 1 degree */
#define STALL_CYCLES 500
#define RUNAWAY_DUTY 0.04
#define RUNAWAY_ANGLE 0.3490658503988659 /* 20 degrees */
#define HOMING_CYCLES 10000u

typedef struct guard {
    bool armed;
    bool homing;
    bool moved;       /* a reset has moved the angle */
    int8_t direction; /* of the drive; 0: none */
    int32_t stalled;  /* cycles driven without motion; negative: backwards */
    double stall_origin;
    double homing_origin;
    uint32_t driven;       /* cycles of homing in which the motor was driven */
    double best;           /* the angle farthest in `direction` */
    uint32_t cycles;       /* since that angle */
    uint32_t half_cycles;  /* from that angle to half of RUNAWAY_ANGLE; 0: not yet */
    double half_travelled; /* distance from that angle at that time */
} guard_t;

static void guard_begin(guard_t *guard, double angle)
{
    guard->stall_origin = angle;
    guard->stalled = 0;
    guard->direction = 0;
}

static int8_t direction_of(double duty, double least)
{
    return (int8_t)(duty >= least ? 1 : duty <= -least ? -1 : 0);
}

/** True if the axis has moved RUNAWAY_ANGLE against its drive, and was not slower in the second half of this way. */
static bool runs_away(guard_t *guard, double angle, double duty)
{
    const int8_t direction = direction_of(duty, RUNAWAY_DUTY);
    const double against = direction > 0 ? guard->best - angle : angle - guard->best;
    if (direction == 0 || direction != guard->direction || against <= 0.0) {
        guard->direction = direction;
        guard->best = angle;
        guard->cycles = 0;
        guard->half_cycles = 0;
        return false;
    }
    guard->cycles++;
    if (guard->half_cycles == 0 && against >= 0.5 * RUNAWAY_ANGLE) {
        guard->half_cycles = guard->cycles;
        guard->half_travelled = against;
    }
    if (against < RUNAWAY_ANGLE) {
        return false;
    }
    guard->direction = 0;
    return (against - guard->half_travelled) * guard->half_cycles >=
           guard->half_travelled * (guard->cycles - guard->half_cycles);
}

/** True if the axis was driven in one direction for STALL_CYCLES without moving by STALL_ANGLE. */
static bool stalls(guard_t *guard, double angle, double duty)
{
    const double moved = angle - guard->stall_origin;
    if (moved >= STALL_ANGLE || moved <= -STALL_ANGLE) {
        guard->stall_origin = angle;
        guard->stalled = 0;
        return false;
    }
    const int8_t direction = direction_of(duty, STALL_DUTY);
    if (direction != 0) {
        guard->stalled += direction;
    } else if (guard->stalled != 0) {
        guard->stalled -= guard->stalled > 0 ? 1 : -1;
    }
    return guard->stalled >= STALL_CYCLES || guard->stalled <= -STALL_CYCLES;
}

#endif
