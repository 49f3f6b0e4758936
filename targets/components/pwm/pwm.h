/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A PWM output: the share of the time that a pin is active.
 *
 * Needs only the port layer.  Not thread-safe: all calls from one context.
 */
#ifndef EPG_PWM_H
#define EPG_PWM_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/finite.h"
#include "epg/port.h"

typedef struct epg_pwm_config {
    epg_port_pwm_t pwm;
    bool invert;      /**< active low: duty 0 is a pin that is always high */
    double max_duty;  /**< 0 ... 1 */
    double safe_duty; /**< 0 ... 1; `max_duty` does not limit it */
} epg_pwm_config_t;

/** `duty` 0 ... 1 as the level of the pin, rounded to a whole number of timer clocks. */
static inline uint32_t epg_pwm_level(const epg_pwm_config_t *config, double duty)
{
    const uint32_t clocks = config->pwm.top + 1U;
    const uint32_t level = (uint32_t)(duty * (double)clocks + 0.5);
    return config->invert ? clocks - level : level;
}

/** Sets a level as epg_pwm_level() and epg_pwm_command() give it. */
static inline void epg_pwm_apply(const epg_pwm_config_t *config, uint32_t level)
{
    epg_port_pwm_write(&config->pwm, level);
}

static inline void epg_pwm_safe(const epg_pwm_config_t *config)
{
    epg_pwm_apply(config, epg_pwm_level(config, config->safe_duty));
}

/**
 * Starts with the safe duty, and returns its level; an inverted output is low until the port takes the level over, at
 * the next period.
 */
static inline uint32_t epg_pwm_start(const epg_pwm_config_t *config)
{
    epg_port_pwm_start(&config->pwm);
    epg_pwm_safe(config);
    return epg_pwm_level(config, config->safe_duty);
}

/**
 * `level` for `duty`.  Returns true if that had to be limited to 0 ... max_duty.  A duty that is not finite gives the
 * safe duty, and counts as limited.
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
