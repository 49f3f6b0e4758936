/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The host platform: a target runs on a PC against a simulated plant, in simulated or in real time.
 *
 * Peripherals are simulated at the level of their signals: encoder counts, PWM levels, pin levels.  The generated
 * file `<name>_plant.c` connects them to the plant model.
 */
#ifndef EPG_HOST_H
#define EPG_HOST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/plant.h"
#include "epg/target.h"

/** A signal that can be recorded at each control cycle. */
typedef struct epg_host_signal {
    const char *name; /**< "inputs.position_pan", "plant.outputs.angle_pan" */
    const double *value;
} epg_host_signal_t;

/** A component that reads one input pin. */
typedef struct epg_host_input {
    const char *name; /**< of the component */
    uint8_t pin;
    bool invert; /**< the component reads 1 when the pin is low */
} epg_host_input_t;

/** All the host needs to run one target.  `plant` is NULL when there is none: then sensors stand still. */
typedef struct epg_host_target {
    const epg_target_t *target;
    const epg_plant_t *plant;
    size_t signal_count;
    const epg_host_signal_t *signals;
    size_t plant_output_count;
    const epg_host_signal_t *plant_outputs; /**< those of `signals` that the plant computes */
    size_t input_count;
    const epg_host_input_t *inputs;
    const char *agent;  /**< where the agent of the target's middleware is: HOST:PORT, or a terminal; NULL: no agent */
    uint32_t baud_rate; /**< of that terminal */
} epg_host_target_t;

/** Body of main() of a host executable: reads options, runs, prints a summary.  Returns the exit status. */
int epg_host_main(const epg_host_target_t *host, int argc, char **argv);

/** Starts the control cycle in a thread of its own, in real time, and returns; false when that fails. */
bool epg_host_start(const epg_host_target_t *host);

/**
 * Ends the threads started by epg_host_start(), the control thread after the current cycle; outputs are safe then.
 * False, and everything goes on, when one of these threads is the caller.
 */
bool epg_host_stop(void);

#endif
