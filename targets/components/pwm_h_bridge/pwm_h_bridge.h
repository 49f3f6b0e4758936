/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An H-bridge with one PWM input and two direction inputs: signed duty.
 *
 * | a | b | PWM         | motor                                 |
 * |---|---|-------------|---------------------------------------|
 * | 1 | 0 | `duty`      | driven forwards for the share `duty`  |
 * | 0 | 1 | `duty`      | driven backwards for the share `duty` |
 * | 0 | 0 | low         | coasts                                |
 * | 1 | 1 | always high | brakes: its terminals are connected   |
 *
 * With a and b equal the motor is not driven at any level of the PWM: both its terminals are at one supply rail, or open.
 * With the PWM low it is not driven at any levels of a and b.  These are the safe_states in component.yaml.
 *
 * This is the table of L298, TB6612 and VNH5019 and their relatives.  Both direction pins are high only where the
 * configuration asks for the brake.  Needs only the port layer.  Not thread-safe: all calls from one context.
 */
#ifndef EPG_PWM_H_BRIDGE_H
#define EPG_PWM_H_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/bridge.h"
#include "epg/port.h"

typedef struct epg_pwm_h_bridge_config {
    epg_port_pwm_t pwm;
    uint8_t pin_a; /**< high to drive forwards */
    uint8_t pin_b; /**< high to drive backwards */
    epg_bridge_config_t bridge;
} epg_pwm_h_bridge_config_t;

/** State of one bridge; set by epg_pwm_h_bridge_start(). */
typedef struct epg_pwm_h_bridge {
    epg_bridge_t bridge;
    epg_bridge_state_t shown; /**< what the direction pins say */
} epg_pwm_h_bridge_t;

/** Configures pins and PWM; the motor coasts until this ends, and is safe then. */
void epg_pwm_h_bridge_start(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config);

/** Lets the motor coast, or brakes it.  Writes all signals whatever they were. */
void epg_pwm_h_bridge_safe(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config);

/** Direction pins as the bridge's state says; off in between, with the PWM low. */
void epg_pwm_h_bridge_change(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config);

/**
 * What the bridge is to do for `duty` (-1 ... 1), rounded to a whole number of timer clocks; no pin changes yet.
 * Returns true if it had to be limited to +-max_duty.  A duty that is not finite makes the bridge safe, and counts as
 * limited.
 */
static inline bool epg_pwm_h_bridge_command(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config,
                                            double duty)
{
    return epg_bridge_command(&bridge->bridge, &config->bridge, config->pwm.top + 1U, duty);
}

/**
 * Does it, which takes a few writes and no arithmetic.
 *
 * When the direction changes, the bridge is off before the pins change and while they do.  A PWM that takes a level
 * over at its next period only may give the rest of the present period with the level from before, in the new
 * direction, unless there is a dead time.
 */
static inline void epg_pwm_h_bridge_apply(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    if (bridge->bridge.state != bridge->shown) {
        epg_pwm_h_bridge_change(bridge, config);
    }
    epg_port_pwm_write(&config->pwm, bridge->bridge.level);
}

#endif
