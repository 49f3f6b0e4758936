/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A pin that is toggled at a point of the program, for a logic analyser.
 *
 * Needs only the port layer.  Not thread-safe: all calls from one context.
 */
#ifndef EPG_TIMING_PROBE_H
#define EPG_TIMING_PROBE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/port.h"

/** State of one probe; set by epg_timing_probe_start(). */
typedef struct epg_timing_probe {
    uint8_t pin;
    bool level;
} epg_timing_probe_t;

/** The pin is low until it is toggled first. */
static inline void epg_timing_probe_start(epg_timing_probe_t *probe, uint8_t pin)
{
    *probe = (epg_timing_probe_t){.pin = pin};
    epg_port_output_start(pin, false);
}

static inline void epg_timing_probe_toggle(epg_timing_probe_t *probe)
{
    probe->level = !probe->level;
    epg_port_output_write(probe->pin, probe->level);
}

#endif
