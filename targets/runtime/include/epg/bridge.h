/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A DC motor on an H-bridge: from a signed duty to a state and a PWM level.
 *
 * An H-bridge connects each of the two terminals of a motor to the supply, to ground, or to nothing.  It can therefore
 * drive the motor in both directions, let it coast, or brake it.  A PWM switches the drive on and off; the *duty* is
 * the share of the time for which it is on.  Its sign is the direction: -1 is full speed backwards, 1 full speed
 * forwards.
 *
 * This file does the part that does not depend on the pins of a bridge.  It limits the duty, selects driving, coasting
 * or braking, and keeps a dead time between the two directions.  The driver of a bridge then turns `state` and `level`
 * into the signals of its pins.
 *
 * Not thread-safe: all calls must come from one context.
 */
#ifndef EPG_BRIDGE_H
#define EPG_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/finite.h"
#include "epg/soft_double.h"

/** The state of a bridge. */
typedef enum epg_bridge_state {
    EPG_BRIDGE_COAST, /**< all switches are open; only friction slows the motor down */
    EPG_BRIDGE_BRAKE, /**< the terminals of the motor are connected to each other */
    EPG_BRIDGE_FORWARDS,
    EPG_BRIDGE_BACKWARDS
} epg_bridge_state_t;

typedef struct epg_bridge_config {
    bool invert;             /**< true: a positive duty drives backwards */
    double max_duty;         /**< limit of the duty's magnitude, 0 ... 1 */
    epg_bridge_state_t zero; /**< state at duty 0: coast or brake */
    epg_bridge_state_t safe; /**< state before the first cycle, while disabled, and for a duty that is not finite */
    uint32_t dead_writes;    /**< dead time: commands for which the bridge coasts between two directions; 0: none */
} epg_bridge_config_t;

/** The present state of one bridge.  Zero-initialised memory is a bridge that coasts and has never driven. */
typedef struct epg_bridge {
    double duty;    /**< applied duty, -1 ... 1, with the sign of the command; 0 if not driven */
    uint32_t level; /**< PWM level in clocks; while braking, the whole period */
    epg_bridge_state_t state;
    epg_bridge_state_t driven; /**< direction of the last drive; EPG_BRIDGE_COAST before the first one */
    uint32_t coasted;          /**< commands in a row that left the bridge coasting; stops at `dead_writes` */
} epg_bridge_t;

/** Stops driving.  `state` is EPG_BRIDGE_COAST or EPG_BRIDGE_BRAKE, `clocks` the PWM period in clocks. */
void epg_bridge_rest(epg_bridge_t *bridge, const epg_bridge_config_t *config, uint32_t clocks,
                     epg_bridge_state_t state);

/**
 * Changes to `direction`.  Returns false, and lets the motor coast, while the dead time since the other direction is
 * not over.
 */
bool epg_bridge_turn(epg_bridge_t *bridge, const epg_bridge_config_t *config, epg_bridge_state_t direction);

/** Sets state and level for the safe value.  `clocks` is the PWM period in clocks. */
static inline void epg_bridge_make_safe(epg_bridge_t *bridge, const epg_bridge_config_t *config, uint32_t clocks)
{
    epg_bridge_rest(bridge, config, clocks, config->safe);
}

/**
 * Sets state and level for `duty` (-1 ... 1).  The level is rounded to whole clocks of a PWM period of `clocks`.
 * Returns true if the duty was limited to +-max_duty.  A duty that is not finite gives the safe state, and counts as
 * limited.
 */
static inline bool epg_bridge_command(epg_bridge_t *bridge, const epg_bridge_config_t *config, uint32_t clocks,
                                      double duty)
{
    if (!epg_is_finite(duty)) {
        epg_bridge_make_safe(bridge, config, clocks);
        return true;
    }
    const bool negative = epg_less(duty, 0.0);
    const double asked = negative ? -duty : duty;
    const bool limited = epg_less(config->max_duty, asked);
    const double magnitude = limited ? config->max_duty : asked;
    const uint32_t level = (uint32_t)(magnitude * (double)clocks + 0.5);
    const epg_bridge_state_t direction = negative == config->invert ? EPG_BRIDGE_FORWARDS : EPG_BRIDGE_BACKWARDS;
    if (level == 0) {
        epg_bridge_rest(bridge, config, clocks, config->zero);
    } else if (direction == bridge->state || epg_bridge_turn(bridge, config, direction)) {
        bridge->duty = negative ? -magnitude : magnitude;
        bridge->level = level;
    }
    return limited;
}

#endif
