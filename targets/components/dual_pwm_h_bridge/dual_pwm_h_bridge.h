/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An H-bridge with two PWM inputs, one for each direction, as an actuator with a signed duty.
 *
 * An H-bridge connects each terminal of a DC motor to the supply or to ground, so it can drive the motor in both
 * directions (epg/bridge.h).  Its two inputs select the state of the motor:
 *
 * | forwards input | backwards input | motor    |
 * |----------------|-----------------|----------|
 * | 1              | 0               | forwards |
 * | 0              | 1               | backwards|
 * | 0              | 0               | coasts   |
 * | 1              | 1               | brakes   |
 *
 * This is the table of DRV8833, DRV8871, DRV8212, L9110 and similar bridges.
 *
 * A PWM drives the motor for the share `duty` of each period.  `slow_decay` selects its state in the rest of the
 * period: coast, in which the current decays fast, or brake, in which it decays slowly.  Slow decay makes the speed
 * more nearly proportional to the duty.
 *
 * The level of one input alone is never safe, because the other input decides.  Each of the safe_states in
 * component.yaml therefore lists both inputs.
 *
 * Needs only the port layer.  Not thread-safe: all calls must come from one context.
 */
#ifndef EPG_DUAL_PWM_H_BRIDGE_H
#define EPG_DUAL_PWM_H_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/bridge.h"
#include "epg/port.h"

typedef struct epg_dual_pwm_h_bridge_config {
    epg_port_pwm_t forwards;
    epg_port_pwm_t backwards; /**< must have the same period */
    bool slow_decay;          /**< state between the pulses; true: brake, false: coast */
    epg_bridge_config_t bridge;
} epg_dual_pwm_h_bridge_config_t;

/** The state of one bridge; epg_dual_pwm_h_bridge_start() sets it. */
typedef struct epg_dual_pwm_h_bridge {
    epg_bridge_t bridge;
} epg_dual_pwm_h_bridge_t;

/**
 * Writes the levels of both inputs for the state of the bridge.
 *
 * A PWM period can end between the two writes, and the second write can fail.  Even then the motor must not be driven
 * in a direction that is neither that of its last drive nor that of the next one.  The input that ends a drive, or that
 * is held high with slow decay, is therefore written first.
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

/** Makes the bridge safe: the motor coasts or brakes, as configured. */
static inline void epg_dual_pwm_h_bridge_safe(epg_dual_pwm_h_bridge_t *bridge,
                                              const epg_dual_pwm_h_bridge_config_t *config)
{
    epg_bridge_make_safe(&bridge->bridge, &config->bridge, config->forwards.top + 1U);
    epg_dual_pwm_h_bridge_set(bridge, config);
}

/** Configures both PWMs.  The motor coasts meanwhile; afterwards it is in its safe state. */
static inline void epg_dual_pwm_h_bridge_start(epg_dual_pwm_h_bridge_t *bridge,
                                               const epg_dual_pwm_h_bridge_config_t *config)
{
    *bridge = (epg_dual_pwm_h_bridge_t){0};
    epg_port_pwm_start(&config->forwards);
    epg_port_pwm_start(&config->backwards);
    epg_dual_pwm_h_bridge_safe(bridge, config);
}

/**
 * Computes the state of the bridge for `duty` (-1 ... 1), rounded to a whole number of timer clocks.  No pin changes
 * before epg_dual_pwm_h_bridge_set() is called.  Returns true if the duty was limited to +-max_duty.  A duty that is
 * not finite gives the safe state, and counts as limited.
 */
static inline bool epg_dual_pwm_h_bridge_command(epg_dual_pwm_h_bridge_t *bridge,
                                                 const epg_dual_pwm_h_bridge_config_t *config, double duty)
{
    return epg_bridge_command(&bridge->bridge, &config->bridge, config->forwards.top + 1U, duty);
}

#endif
