/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A guard that compares the duty of a motor with the encoder on its axis, and finds broken wires and blocked motors.
 *
 * | found                  | fault           | possible cause                                                        |
 * |------------------------|-----------------|-----------------------------------------------------------------------|
 * | no counts while driving| stall           | encoder dead or unplugged; motor blocked, unplugged or without power  |
 * | counts against the     | runaway         | wires of encoder or motor swapped: the feedback then drives, though   |
 * | drive                  |                 | it should brake                                                       |
 * | homing too far         | homing travel   | the end stop is at the wrong place, or its switch does not work       |
 * | homing too long        | homing time     | the same; or the encoder is dead, or the motor too weak               |
 *
 * The guard is armed while the target is enabled, so an axis that is moved by hand while disabled is not a fault.
 * *Homing* lasts from enabling to the encoder's first reset.  An axis that is at its end stop meanwhile is not a stall.
 *
 * The guard uses the applied duty, which can differ from the duty that the model has computed.  A positive duty must
 * make the angle grow; the parameter `invert` of encoder and bridge serves this.  Times are counted in control cycles.
 *
 * Needs only its arguments.  Not thread-safe: all calls must come from one context.
 */
#ifndef EPG_MOTION_GUARD_H
#define EPG_MOTION_GUARD_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/fault.h"
#include "epg/soft_double.h"

typedef struct epg_motion_guard_config {
    struct {
        double duty;    /**< at this duty or more (> 0) the axis must move */
        double angle;   /**< rad; a smaller movement counts as standing still */
        int32_t cycles; /**< how long the axis may stand still; 0: no such check */
    } stall;
    struct {
        double duty;  /**< at this duty or more (> 0) the axis must not move the other way */
        double angle; /**< rad; movement the other way that is a runaway; 0: no such check */
    } runaway;
    struct {
        double travel;   /**< rad; largest distance, in both directions, from the angle at enabling */
        uint32_t cycles; /**< how long the motor may be driven; 0: no such check */
    } homing;
    struct {
        epg_fault_t stall;
        epg_fault_t runaway;
        epg_fault_t homing_travel;
        epg_fault_t homing_time;
    } faults; /**< the numbers of the faults, as component.yaml declares them */
} epg_motion_guard_config_t;

/** The state of one guard; epg_motion_guard_start() sets it. */
typedef struct epg_motion_guard {
    bool armed;
    uint32_t resets; /**< number of resets of the encoder at the last check */

    double stall_origin; /**< angle from which the stall check measures motion */
    int32_t stalled;     /**< cycles driven without motion: forwards positive, backwards negative */

    int8_t direction;      /**< direction of the drive in the runaway check; 0: none */
    double best;           /**< the angle farthest in that direction */
    uint32_t cycles;       /**< cycles since that angle */
    uint32_t half_cycles;  /**< cycles from that angle until half of `runaway.angle` was reached; 0: not yet */
    double half_travelled; /**< distance from that angle at that moment */

    bool homing;
    double homing_origin;
    uint32_t driven; /**< cycles of homing in which the motor was driven */
} epg_motion_guard_t;

/** Starts with a guard that is not armed. */
static inline void epg_motion_guard_start(epg_motion_guard_t *guard)
{
    *guard = (epg_motion_guard_t){0};
}

/** Makes `angle` the origin of all measurements.  Called when the guard is armed, and when a reset moved the angle. */
static inline void epg_motion_guard_begin(epg_motion_guard_t *guard, double angle)
{
    guard->stall_origin = angle;
    guard->stalled = 0;
    guard->direction = 0;
}

/** Returns the direction of the drive: 1, -1, or 0 if the duty is smaller than `least`. */
static inline int8_t epg_motion_guard_direction(double duty, double least)
{
    return (int8_t)(epg_at_most(least, duty) ? 1 : epg_at_most(duty, -least) ? -1 : 0);
}

/**
 * Returns true if the axis was driven in one direction for long enough without motion.
 *
 * Each cycle in which it is driven less, or in the other direction, cancels one cycle of the count.  A duty that
 * dithers around zero therefore never counts as a stall, but a drive with short gaps does.
 */
static inline bool epg_motion_guard_stalls(epg_motion_guard_t *guard, const epg_motion_guard_config_t *config,
                                           double angle, double duty)
{
    const double moved = angle - guard->stall_origin;
    if (epg_at_most(config->stall.angle, moved) || epg_at_most(moved, -config->stall.angle)) {
        guard->stall_origin = angle;
        guard->stalled = 0;
        return false;
    }
    const int8_t direction = epg_motion_guard_direction(duty, config->stall.duty);
    if (direction != 0) {
        guard->stalled += direction;
    } else if (guard->stalled != 0) {
        guard->stalled -= guard->stalled > 0 ? 1 : -1;
    }
    return guard->stalled >= config->stall.cycles || guard->stalled <= -config->stall.cycles;
}

/**
 * Returns true if the axis has moved against the drive by `runaway.angle`, and was not slower in the second half of
 * this distance than in the first.  An axis that brakes moves against the drive, too, but it becomes slower.  An axis
 * that runs away does not.
 */
static inline bool epg_motion_guard_runs_away(epg_motion_guard_t *guard, const epg_motion_guard_config_t *config,
                                              double angle, double duty)
{
    const int8_t direction = epg_motion_guard_direction(duty, config->runaway.duty);
    if (direction == 0 || direction != guard->direction ||
        (direction > 0 ? epg_at_most(guard->best, angle) : epg_at_most(angle, guard->best))) {
        guard->direction = direction;
        guard->best = angle;
        guard->cycles = 0;
        guard->half_cycles = 0;
        return false;
    }
    const double against = direction > 0 ? guard->best - angle : angle - guard->best;
    guard->cycles++;
    if (guard->half_cycles == 0 && epg_at_most(0.5 * config->runaway.angle, against)) {
        guard->half_cycles = guard->cycles;
        guard->half_travelled = against;
    }
    if (epg_less(against, config->runaway.angle)) {
        return false;
    }
    const double first = guard->half_travelled * (double)(guard->cycles - guard->half_cycles);
    const double second = (against - guard->half_travelled) * (double)guard->half_cycles;
    guard->direction = 0; /* if it is slower, the check begins again from here */
    return second >= first;
}

/** Checks distance and time of homing. */
static inline epg_fault_t epg_motion_guard_homes(epg_motion_guard_t *guard, const epg_motion_guard_config_t *config,
                                                 double angle, double duty)
{
    const double travelled = angle - guard->homing_origin;
    if (epg_less(config->homing.travel, travelled) || epg_less(travelled, -config->homing.travel)) {
        return config->faults.homing_travel;
    }
    if (epg_less(duty, 0.0) || epg_less(0.0, duty)) {
        guard->driven++;
    }
    return guard->driven > config->homing.cycles ? config->faults.homing_time : EPG_FAULT_NONE;
}

/**
 * Makes all checks.  Must be called once per control cycle, after the sensors were sampled.  Returns EPG_FAULT_NONE or
 * the fault.
 *
 * `enabled`: the target is enabled in this cycle.  `angle`: the sampled angle in rad.  `resets`: how often a reset has
 * moved this angle so far.  `duty`: the duty applied since the last cycle, -1 ... 1.
 */
static inline epg_fault_t epg_motion_guard_check(epg_motion_guard_t *guard, const epg_motion_guard_config_t *config,
                                                 bool enabled, double angle, uint32_t resets, double duty)
{
    if (!enabled) {
        guard->armed = false;
        return EPG_FAULT_NONE;
    }
    if (!guard->armed) {
        guard->armed = true;
        guard->resets = resets;
        guard->homing = config->homing.cycles > 0;
        guard->homing_origin = angle;
        guard->driven = 0;
        epg_motion_guard_begin(guard, angle);
    } else if (resets != guard->resets) {
        guard->resets = resets;
        guard->homing = false;
        epg_motion_guard_begin(guard, angle);
    }
    if (config->runaway.angle > 0.0 && epg_motion_guard_runs_away(guard, config, angle, duty)) {
        return config->faults.runaway;
    }
    if (guard->homing) {
        return epg_motion_guard_homes(guard, config, angle, duty);
    }
    if (config->stall.cycles > 0 && epg_motion_guard_stalls(guard, config, angle, duty)) {
        return config->faults.stall;
    }
    return EPG_FAULT_NONE;
}

#endif
