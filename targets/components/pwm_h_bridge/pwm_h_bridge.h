/**
 * @file
 * An H-bridge with one PWM input and two direction inputs: signed duty.
 *
 * | a | b | motor                                 |
 * |---|---|---------------------------------------|
 * | 1 | 0 | driven forwards for the share `duty`  |
 * | 0 | 1 | driven backwards for the share `duty` |
 * | 0 | 0 | coasts: safe, and duty 0              |
 *
 * Both high (short-circuit brake) never occurs.  Needs only the port layer.  Not thread-safe: all calls from one
 * context.
 */
#ifndef EPG_PWM_H_BRIDGE_H
#define EPG_PWM_H_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/finite.h"
#include "epg/port.h"

typedef struct epg_pwm_h_bridge_config {
    epg_port_pwm_t pwm;
    uint8_t pin_a;   /**< high for positive duty */
    uint8_t pin_b;   /**< high for negative duty */
    bool invert;     /**< positive duty drives backwards */
    double max_duty; /**< 0 ... 1 */
} epg_pwm_h_bridge_config_t;

/** State of one bridge; set by epg_pwm_h_bridge_start(). */
typedef struct epg_pwm_h_bridge {
    int8_t direction; /**< as the pins are: 1, 0 or -1 */
} epg_pwm_h_bridge_t;

/** Lets the motor coast.  Writes all signals whatever they were. */
static inline void epg_pwm_h_bridge_safe(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    epg_port_pwm_write(&config->pwm, 0);
    epg_port_output_write(config->pin_a, false);
    epg_port_output_write(config->pin_b, false);
    bridge->direction = 0;
}

/** Configures pins and PWM; the motor coasts. */
static inline void epg_pwm_h_bridge_start(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    epg_port_output_start(config->pin_a, false);
    epg_port_output_start(config->pin_b, false);
    epg_port_pwm_start(&config->pwm);
    epg_pwm_h_bridge_safe(bridge, config);
}

/**
 * Drives with `duty` (-1 ... 1), rounded to a whole number of timer clocks.  Returns true if it had to be limited to
 * +-max_duty.  A duty that is not finite lets the motor coast, and counts as limited.
 *
 * When the direction changes, the bridge is off before the pins change and while they do.  A PWM that takes a level
 * over at its next period only may give the rest of the present period with the level from before, in the new
 * direction; it never drives against the direction asked for.
 */
static inline bool epg_pwm_h_bridge_write(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config,
                                          double duty)
{
    if (!epg_is_finite(duty)) {
        epg_pwm_h_bridge_safe(bridge, config);
        return true;
    }
    const bool negative = duty < 0.0;
    const double asked = negative ? -duty : duty;
    const bool limited = asked > config->max_duty;
    const double magnitude = limited ? config->max_duty : asked;
    const uint32_t level = (uint32_t)(magnitude * ((double)config->pwm.top + 1.0) + 0.5);
    const int8_t direction = level == 0 ? 0 : negative == config->invert ? 1 : -1;

    if (direction != bridge->direction) {
        epg_pwm_h_bridge_safe(bridge, config);
        epg_port_output_write(config->pin_a, direction > 0);
        epg_port_output_write(config->pin_b, direction < 0);
        bridge->direction = direction;
    }
    epg_port_pwm_write(&config->pwm, level);
    return limited;
}

#endif
