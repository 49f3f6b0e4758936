/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A PWM output as an actuator: a pin that is active for the share `duty` of each PWM period.
 *
 * The duty is rounded to a whole number of timer clocks, so a period of `top + 1` clocks has `top + 2` different
 * levels.
 *
 * Needs only the port layer.  Not thread-safe: all calls must come from one context.
 */
#ifndef EPG_PWM_H
#define EPG_PWM_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/finite.h"
#include "epg/port.h"

typedef struct epg_pwm_config {
    epg_port_pwm_t pwm;
    bool invert;      /**< true: a low level is active, so the pin is always high at duty 0 */
    double max_duty;  /**< largest duty, 0 ... 1 */
    double safe_duty; /**< duty while disabled, 0 ... 1; `max_duty` does not limit it */
} epg_pwm_config_t;

/** Returns the level (high time in timer clocks) for `duty`, 0 ... 1, rounded to a whole number of clocks. */
static inline uint32_t epg_pwm_level(const epg_pwm_config_t *config, double duty)
{
    const uint32_t clocks = config->pwm.top + 1U;
    const uint32_t level = (uint32_t)(duty * (double)clocks + 0.5);
    return config->invert ? clocks - level : level;
}

/** Writes a level from epg_pwm_level() or epg_pwm_command(). */
static inline void epg_pwm_apply(const epg_pwm_config_t *config, uint32_t level)
{
    epg_port_pwm_write(&config->pwm, level);
}

/** Writes the level of the safe duty. */
static inline void epg_pwm_safe(const epg_pwm_config_t *config)
{
    epg_pwm_apply(config, epg_pwm_level(config, config->safe_duty));
}

/**
 * Starts the PWM with the safe duty and returns its level.  An inverted output is low until this level takes effect at
 * the next PWM period.
 */
static inline uint32_t epg_pwm_start(const epg_pwm_config_t *config)
{
    epg_port_pwm_start(&config->pwm);
    epg_pwm_safe(config);
    return epg_pwm_level(config, config->safe_duty);
}

/**
 * Computes `*level` for `duty`.  Returns true if the duty was limited to 0 ... max_duty.  A duty that is not finite
 * gives the safe duty, and counts as limited.
 */
static inline bool epg_pwm_command(const epg_pwm_config_t *config, double duty, uint32_t *level)
{
    if (!epg_is_finite(duty)) {
        *level = epg_pwm_level(config, config->safe_duty);
        return true;
    }
    if (duty < 0.0 || duty > config->max_duty) {
        *level = epg_pwm_level(config, duty < 0.0 ? 0.0 : config->max_duty);
        return true;
    }
    *level = epg_pwm_level(config, duty);
    return false;
}

#endif
