/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A digital output driven by a number: on above 0.5.
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
    bool invert; /**< on is a low level */
    bool safe;   /**< on (true) or off from the start and while disabled */
} epg_digital_output_config_t;

static inline void epg_digital_output_start(const epg_digital_output_config_t *config)
{
    epg_port_output_start(config->pin, config->safe != config->invert);
}

/** On if `value` > 0.5; NaN is off. */
static inline void epg_digital_output_write(const epg_digital_output_config_t *config, double value)
{
    epg_port_output_write(config->pin, (value > 0.5) != config->invert);
}

static inline void epg_digital_output_safe(const epg_digital_output_config_t *config)
{
    epg_port_output_write(config->pin, config->safe != config->invert);
}

#endif
