/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A digital input as a number: 1 if the input is active, 0 if not.
 *
 * A switch, for example, connects the pin to ground.  A pull-up resistor then makes the pin high while the switch is
 * open, so the input is active low (`invert`).
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
    bool invert; /**< true: a low level is active */
} epg_digital_input_config_t;

/** Configures the pin. */
static inline void epg_digital_input_start(const epg_digital_input_config_t *config)
{
    epg_port_input_start(config->pin, config->pull);
}

/**
 * Returns 1.0 if the input is active now, otherwise 0.0.  A fail-safe input is read early in a cycle, so no sample is
 * kept.
 */
static inline double epg_digital_input_read(const epg_digital_input_config_t *config)
{
    return epg_port_input_read(config->pin) != config->invert ? 1.0 : 0.0;
}

#endif
