/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Watches a motor and the encoder of what it moves.
 *
 * | found                  | fault           | what it is                                                           |
 * |------------------------|-----------------|----------------------------------------------------------------------|
 * | no counts while driving| STALL           | encoder dead or unplugged, motor blocked, unplugged or without power |
 * | counts against the     | RUNAWAY         | wires of encoder or motor swapped: feedback that should brake drives |
 * | drive                  |                 |                                                                      |
 * | homing too far         | HOMING_TRAVEL   | the end stop is not where it should be, or nothing sees it           |
 * | homing too long        | HOMING_TIME     | the same; or encoder dead, motor too weak                            |
 *
 * Armed while the target is enabled: an axis that is moved by hand while disabled is no fault.  *Homing* lasts from
 * enabling to the encoder's first reset; an axis that stands at its end stop then is no stall.
 *
 * The guard sees the duty that is applied, and not what a model asked for; a positive one must make the angle grow
 * (what `invert` of encoder and bridge is for).  Times are counted in control cycles.
 *
 * Needs nothing but its arguments.  Not thread-safe: all calls from one context.
 */
#ifndef EPG_MOTION_GUARD_H
#define EPG_MOTION_GUARD_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/fault.h"

typedef struct epg_motion_guard_config {
    struct {
        double duty;    /**< > 0: from this duty on the axis has to move */
        double angle;   /**< rad: less than this is no motion */
        int32_t cycles; /**< for which it may stand still; 0: no such check */
    } stall;
    struct {
        double duty;  /**< > 0: from this duty on the axis must not move the other way */
        double angle; /**< rad: by so much; 0: no such check */
    } runaway;
    struct {
        double travel;   /**< rad, either way from where it stood when the target was enabled */
        uint32_t cycles; /**< for which the motor may be driven; 0: no such check */
    } homing;
} epg_motion_guard_config_t;

/** State of one guard; set by epg_motion_guard_start(). */
typedef struct epg_motion_guard {
    bool armed;
    uint32_t resets; /**< of the encoder, as seen last */

    double stall_origin; /**< where motion is measured from */
    int32_t stalled;     /**< cycles driven without motion: forwards positive, backwards negative */

    int8_t direction;      /**< of the drive that the runaway check looks at; 0: none */
    double best;           /**< farthest in that direction */
    uint32_t cycles;       /**< since then */
    uint32_t half_cycles;  /**< after how many of them half the angle was reached; 0: not yet */
    double half_travelled; /**< and how far it was then */

    bool homing;
    double homing_origin;
    uint32_t driven; /**< cycles of homing in which the motor was driven */
} epg_motion_guard_t;

static inline void epg_motion_guard_start(epg_motion_guard_t *guard)
{
    *guard = (epg_motion_guard_t){0};
}

/** Motion is measured from `angle` on: the guard is armed, or the angle has jumped. */
static inline void epg_motion_guard_begin(epg_motion_guard_t *guard, double angle)
{
    guard->stall_origin = angle;
    guard->stalled = 0;
    guard->direction = 0;
}

/** 1, -1, or 0 while the duty is too small to tell. */
static inline int8_t epg_motion_guard_direction(double duty, double least)
{
    return (int8_t)(duty >= least ? 1 : duty <= -least ? -1 : 0);
}

/**
 * True when the axis has not moved though it was driven one way for long enough.  Cycles in which it is driven less,
 * or the other way, take back as many: a duty that dithers or shakes is no drive, one with short gaps is.
 */
static inline bool epg_motion_guard_stalls(epg_motion_guard_t *guard, const epg_motion_guard_config_t *config,
                                           double angle, double duty)
{
    const double moved = angle - guard->stall_origin;
    if (moved >= config->stall.angle || moved <= -config->stall.angle) {
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
 * True when the axis has moved against the drive by `angle`, the second half of it not slower than the first.  An axis
 * that brakes moves against the drive too, but slower and slower; one that runs away does not.
 */
static inline bool epg_motion_guard_runs_away(epg_motion_guard_t *guard, const epg_motion_guard_config_t *config,
                                              double angle, double duty)
{
    const int8_t direction = epg_motion_guard_direction(duty, config->runaway.duty);
    const double against = direction > 0 ? guard->best - angle : angle - guard->best;
    if (direction == 0 || direction != guard->direction || against <= 0.0) {
        guard->direction = direction;
        guard->best = angle;
        guard->cycles = 0;
        guard->half_cycles = 0;
        return false;
    }
    guard->cycles++;
    if (guard->half_cycles == 0 && against >= 0.5 * config->runaway.angle) {
        guard->half_cycles = guard->cycles;
        guard->half_travelled = against;
    }
    if (against < config->runaway.angle) {
        return false;
    }
    const double first = guard->half_travelled * (double)(guard->cycles - guard->half_cycles);
    const double second = (against - guard->half_travelled) * (double)guard->half_cycles;
    guard->direction = 0; /* if it is slower: from here on again */
    return second >= first;
}

static inline epg_fault_t epg_motion_guard_homes(epg_motion_guard_t *guard, const epg_motion_guard_config_t *config,
                                                 double angle, double duty)
{
    const double travelled = angle - guard->homing_origin;
    if (travelled > config->homing.travel || travelled < -config->homing.travel) {
        return EPG_FAULT_HOMING_TRAVEL;
    }
    if (duty < 0.0 || duty > 0.0) {
        guard->driven++;
    }
    return guard->driven > config->homing.cycles ? EPG_FAULT_HOMING_TIME : EPG_FAULT_NONE;
}

/**
 * What is wrong, if anything is.  Once per control cycle, after sampling: `angle` in rad as sampled, `resets` how often
 * it has jumped by a reset so far, `duty` as applied since the last cycle (-1 ... 1), `enabled` in this cycle.
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
        return EPG_FAULT_RUNAWAY;
    }
    if (guard->homing) {
        return epg_motion_guard_homes(guard, config, angle, duty);
    }
    if (config->stall.cycles > 0 && epg_motion_guard_stalls(guard, config, angle, duty)) {
        return EPG_FAULT_STALL;
    }
    return EPG_FAULT_NONE;
}

#endif
