/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A digital input as a number: 1 when active, 0 when not.
 *
 * Needs only the port layer.
 */
#ifndef EPG_DIGITAL_INPUT_H
#define EPG_DIGITAL_INPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/port.h"

typedef struct epg_digital_input_config {
    uint8_t pin;
    epg_port_pull_t pull;
    bool invert; /**< active low */
} epg_digital_input_config_t;

static inline void epg_digital_input_start(const epg_digital_input_config_t *config)
{
    epg_port_input_start(config->pin, config->pull);
}

/** The level at this moment, and not as sampled at the start of a cycle: a fail-safe input is read before that. */
static inline double epg_digital_input_read(const epg_digital_input_config_t *config)
{
    return epg_port_input_read(config->pin) != config->invert ? 1.0 : 0.0;
}

#endif
