/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A motor on an H-bridge, whatever the bridge's pins are: what a signed duty asks of it.
 *
 * Limits the duty, decides between driving, coasting and braking, and keeps a dead time between the two directions.
 * Drivers of bridges turn the state and the level that epg_bridge_command() leaves into signals.
 */
#ifndef EPG_BRIDGE_H
#define EPG_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/finite.h"

/** What a bridge does with its motor. */
typedef enum epg_bridge_state {
    EPG_BRIDGE_COAST, /**< all switches open: no torque but friction */
    EPG_BRIDGE_BRAKE, /**< the motor's terminals are connected to each other */
    EPG_BRIDGE_FORWARDS,
    EPG_BRIDGE_BACKWARDS
} epg_bridge_state_t;

typedef struct epg_bridge_config {
    bool invert;             /**< a positive duty drives backwards */
    double max_duty;         /**< 0 ... 1 */
    epg_bridge_state_t zero; /**< at duty 0: coast or brake */
    epg_bridge_state_t safe; /**< before the first cycle, while disabled, and for a duty that is not finite */
    uint32_t dead_writes;    /**< commands for which the bridge coasts between two directions; 0: none */
} epg_bridge_config_t;

/** Zero-initialised memory is a bridge that coasts and has never driven. */
typedef struct epg_bridge {
    double duty;               /**< applied now, -1 ... 1, positive as asked for; 0 unless the motor is driven */
    uint32_t level;            /**< of the PWM now, in clocks; while braking all of a period */
    epg_bridge_state_t state;  /**< now */
    epg_bridge_state_t driven; /**< direction of the last drive; EPG_BRIDGE_COAST before the first */
    uint32_t coasted;          /**< commands in a row that left it coasting; stops at `dead_writes` */
} epg_bridge_t;

/** Not driven from now on: coasts or brakes, with a PWM period of `clocks`. */
void epg_bridge_rest(epg_bridge_t *bridge, const epg_bridge_config_t *config, uint32_t clocks,
                     epg_bridge_state_t state);

/** Takes a direction; false, and coasting, unless the dead time since the other one is over. */
bool epg_bridge_turn(epg_bridge_t *bridge, const epg_bridge_config_t *config, epg_bridge_state_t direction);

/** State and level for the safe value, with a PWM period of `clocks`. */
static inline void epg_bridge_make_safe(epg_bridge_t *bridge, const epg_bridge_config_t *config, uint32_t clocks)
{
    epg_bridge_rest(bridge, config, clocks, config->safe);
}

/**
 * State and level for `duty` (-1 ... 1), rounded to whole clocks of a PWM period of `clocks`.  Returns true if it had
 * to be limited to +-max_duty.  A duty that is not finite is made safe, and counts as limited.
 */
static inline bool epg_bridge_command(epg_bridge_t *bridge, const epg_bridge_config_t *config, uint32_t clocks,
                                      double duty)
{
    if (!epg_is_finite(duty)) {
        epg_bridge_make_safe(bridge, config, clocks);
        return true;
    }
    const bool negative = duty < 0.0;
    const double asked = negative ? -duty : duty;
    const bool limited = asked > config->max_duty;
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
