/**
 * @file
 * What the host's own code asks of the simulated peripherals, beyond epg/plant.h.
 */
#ifndef EPG_HOST_PORT_H
#define EPG_HOST_PORT_H

#include <stdbool.h>
#include <stdint.h>

/** True when the application has configured `pin` as a digital input. */
bool epg_host_is_input(uint8_t pin);

#endif
