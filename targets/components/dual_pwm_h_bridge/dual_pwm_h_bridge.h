/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An H-bridge with two PWM inputs, one for each direction: signed duty.
 *
 * | forwards input | backwards input | motor    |
 * |----------------|-----------------|----------|
 * | 1              | 0               | forwards |
 * | 0              | 1               | backwards|
 * | 0              | 0               | coasts   |
 * | 1              | 1               | brakes   |
 *
 * No level of one input alone is safe: the other one decides.  So both are in each of the safe_states in component.yaml.
 *
 * This is the table of DRV8833, DRV8871, DRV8212 and L9110 and their relatives.  `slow_decay` says what the motor does
 * in the rest of each PWM period: coast (the current decays fast) or brake (it decays slowly, which makes speed more
 * nearly proportional to duty).  Needs only the port layer.  Not thread-safe: all calls from one context.
 */
#ifndef EPG_DUAL_PWM_H_BRIDGE_H
#define EPG_DUAL_PWM_H_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/bridge.h"
#include "epg/port.h"

typedef struct epg_dual_pwm_h_bridge_config {
    epg_port_pwm_t forwards;
    epg_port_pwm_t backwards; /**< with the same period */
    bool slow_decay;          /**< brakes (true) or coasts between the pulses */
    epg_bridge_config_t bridge;
} epg_dual_pwm_h_bridge_config_t;

/** State of one bridge; set by epg_dual_pwm_h_bridge_start(). */
typedef struct epg_dual_pwm_h_bridge {
    epg_bridge_t bridge;
} epg_dual_pwm_h_bridge_t;

/**
 * Both levels as the bridge's state says.  When a PWM period ends between the two writes, or the second one fails, the
 * motor is not driven against the direction of its last drive and of the next one: an input that ends a drive, or holds
 * with slow decay, comes first.
 */
static inline void epg_dual_pwm_h_bridge_set(const epg_dual_pwm_h_bridge_t *bridge,
                                             const epg_dual_pwm_h_bridge_config_t *config)
{
    const uint32_t clocks = config->forwards.top + 1U;
    const epg_bridge_state_t state = bridge->bridge.state;
    const bool backwards =
        (state == EPG_BRIDGE_FORWARDS || state == EPG_BRIDGE_BACKWARDS ? state : bridge->bridge.driven) ==
        EPG_BRIDGE_BACKWARDS;
    const epg_port_pwm_t *driving = backwards ? &config->backwards : &config->forwards;
    const epg_port_pwm_t *other = backwards ? &config->forwards : &config->backwards;
    if (state == EPG_BRIDGE_BRAKE) {
        epg_port_pwm_write(driving, clocks);
        epg_port_pwm_write(other, clocks);
    } else if (state == EPG_BRIDGE_COAST) {
        epg_port_pwm_write(other, 0);
        epg_port_pwm_write(driving, 0);
    } else if (config->slow_decay) {
        epg_port_pwm_write(driving, clocks);
        epg_port_pwm_write(other, clocks - bridge->bridge.level);
    } else {
        epg_port_pwm_write(other, 0);
        epg_port_pwm_write(driving, bridge->bridge.level);
    }
}

/** Lets the motor coast, or brakes it. */
static inline void epg_dual_pwm_h_bridge_safe(epg_dual_pwm_h_bridge_t *bridge,
                                              const epg_dual_pwm_h_bridge_config_t *config)
{
    epg_bridge_make_safe(&bridge->bridge, &config->bridge, config->forwards.top + 1U);
    epg_dual_pwm_h_bridge_set(bridge, config);
}

/** Configures both PWMs; the motor coasts until this ends, and is safe then. */
static inline void epg_dual_pwm_h_bridge_start(epg_dual_pwm_h_bridge_t *bridge,
                                               const epg_dual_pwm_h_bridge_config_t *config)
{
    *bridge = (epg_dual_pwm_h_bridge_t){0};
    epg_port_pwm_start(&config->forwards);
    epg_port_pwm_start(&config->backwards);
    epg_dual_pwm_h_bridge_safe(bridge, config);
}

/**
 * What the bridge is to do for `duty` (-1 ... 1), rounded to a whole number of timer clocks: epg_dual_pwm_h_bridge_set()
 * does it.  Returns true if it had to be limited to +-max_duty.  A duty that is not finite makes the bridge safe, and
 * counts as limited.
 */
static inline bool epg_dual_pwm_h_bridge_command(epg_dual_pwm_h_bridge_t *bridge,
                                                 const epg_dual_pwm_h_bridge_config_t *config, double duty)
{
    return epg_bridge_command(&bridge->bridge, &config->bridge, config->forwards.top + 1U, duty);
}

#endif
