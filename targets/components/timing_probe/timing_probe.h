/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A timing probe: a pin that is toggled at one point of the program.
 *
 * A logic analyser or an oscilloscope on the pin shows when the program reaches this point.
 *
 * Needs only the port layer.  Not thread-safe: all calls must come from one context.
 */
#ifndef EPG_TIMING_PROBE_H
#define EPG_TIMING_PROBE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/port.h"

/** The state of one probe; epg_timing_probe_start() sets it. */
typedef struct epg_timing_probe {
    uint8_t pin;
    bool level;
} epg_timing_probe_t;

/** Configures the pin.  It is low until it is toggled for the first time. */
static inline void epg_timing_probe_start(epg_timing_probe_t *probe, uint8_t pin)
{
    *probe = (epg_timing_probe_t){.pin = pin};
    epg_port_output_start(pin, false);
}

/** Changes the level of the pin. */
static inline void epg_timing_probe_toggle(epg_timing_probe_t *probe)
{
    probe->level = !probe->level;
    epg_port_output_write(probe->pin, probe->level);
}

#endif
