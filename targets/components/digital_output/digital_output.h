/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A digital output that follows a number: on above 0.5, otherwise off.
 *
 * Needs only the port layer.
 */
#ifndef EPG_DIGITAL_OUTPUT_H
#define EPG_DIGITAL_OUTPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/port.h"

typedef struct epg_digital_output_config {
    uint8_t pin;
    bool invert; /**< true: a low level is on */
    bool safe;   /**< state before the first cycle and while disabled; true: on */
} epg_digital_output_config_t;

/** Configures the pin with its safe level. */
static inline void epg_digital_output_start(const epg_digital_output_config_t *config)
{
    epg_port_output_start(config->pin, config->safe != config->invert);
}

/** Switches the output on if `value` > 0.5, otherwise off.  NaN switches it off. */
static inline void epg_digital_output_write(const epg_digital_output_config_t *config, double value)
{
    epg_port_output_write(config->pin, (value > 0.5) != config->invert);
}

/** Sets the safe level. */
static inline void epg_digital_output_safe(const epg_digital_output_config_t *config)
{
    epg_port_output_write(config->pin, config->safe != config->invert);
}

#endif
