/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An H-bridge with one PWM input and two direction inputs, as an actuator with a signed duty.
 *
 * An H-bridge connects each terminal of a DC motor to the supply or to ground, so it can drive the motor in both
 * directions (epg/bridge.h).  The direction inputs a and b and the PWM select the state of the motor:
 *
 * | a | b | PWM         | motor                                 |
 * |---|---|-------------|---------------------------------------|
 * | 1 | 0 | `duty`      | driven forwards for the share `duty`  |
 * | 0 | 1 | `duty`      | driven backwards for the share `duty` |
 * | 0 | 0 | low         | coasts                                |
 * | 1 | 1 | always high | brakes: its terminals are connected   |
 *
 * This is the table of L298, TB6612, VNH5019 and similar bridges.
 *
 * If a and b are equal, the motor is not driven at any level of the PWM: both terminals are at the same supply rail, or
 * open.  If the PWM is low, the motor is not driven at any levels of a and b.  These are the safe_states in
 * component.yaml.  Both direction pins are high only if the configuration selects the brake.
 *
 * Needs only the port layer.  Not thread-safe: all calls must come from one context.
 */
#ifndef EPG_PWM_H_BRIDGE_H
#define EPG_PWM_H_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/bridge.h"
#include "epg/port.h"

typedef struct epg_pwm_h_bridge_config {
    epg_port_pwm_t pwm;
    uint8_t pin_a; /**< high: drive forwards */
    uint8_t pin_b; /**< high: drive backwards */
    epg_bridge_config_t bridge;
} epg_pwm_h_bridge_config_t;

/** The state of one bridge; epg_pwm_h_bridge_start() sets it. */
typedef struct epg_pwm_h_bridge {
    epg_bridge_t bridge;
    epg_bridge_state_t shown; /**< the state that the direction pins have */
} epg_pwm_h_bridge_t;

/** Configures the pins and the PWM.  The motor coasts meanwhile; afterwards it is in its safe state. */
void epg_pwm_h_bridge_start(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config);

/** Makes the bridge safe: the motor coasts or brakes, as configured.  Writes all signals, whatever their levels are. */
void epg_pwm_h_bridge_safe(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config);

/** Sets the direction pins for the state of the bridge.  Before that, it switches the bridge off, with the PWM low. */
void epg_pwm_h_bridge_change(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config);

/**
 * Computes the state of the bridge for `duty` (-1 ... 1), rounded to a whole number of timer clocks.  No pin changes
 * before epg_pwm_h_bridge_apply() is called.  Returns true if the duty was limited to +-max_duty.  A duty that is not
 * finite gives the safe state, and counts as limited.
 */
static inline bool epg_pwm_h_bridge_command(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config,
                                            double duty)
{
    return epg_bridge_command(&bridge->bridge, &config->bridge, config->pwm.top + 1U, duty);
}

/**
 * Writes the computed state to the pins.  This takes a few writes and no arithmetic.
 *
 * When the direction changes, the bridge is switched off before the pins change.  A PWM, however, takes a new level
 * only at its next period.  Without a dead time, it may therefore drive the rest of the present period in the new
 * direction with the old level.
 */
static inline void epg_pwm_h_bridge_apply(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    if (bridge->bridge.state != bridge->shown) {
        epg_pwm_h_bridge_change(bridge, config);
    }
    epg_port_pwm_write(&config->pwm, bridge->bridge.level);
}

#endif
