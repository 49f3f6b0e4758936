/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The host platform: a target runs on a PC against a simulated plant.
 *
 * The target has the same model, components and control loop as on a board.  Its peripherals are simulated at the level
 * of their signals: encoder counts, PWM levels, pin levels.  Generated functions connect them to the plant model.
 *
 * A run is in simulated or in real time.  Simulated time has one thread, does not wait, and gives the same result every
 * time; a control cycle takes no simulated time.  In real time, a control thread wakes up at each tick.
 *
 * An executable has EPG's main(), which calls epg_host_main(), or a main() of the user, which calls the generated
 * `<name>_start()` and `<name>_stop()`.
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

/** A target with its plant and signals; generated. */
typedef struct epg_host_target {
    const epg_target_t *target;
    const epg_plant_t *plant; /**< NULL if there is no plant: the sensors' values then stay constant */
    size_t signal_count;
    const epg_host_signal_t *signals; /**< all signals that can be recorded */
    size_t plant_output_count;
    const epg_host_signal_t *plant_outputs; /**< the part of `signals` that the plant computes */
    size_t function_count;
    const char *const *functions; /**< functions of the model whose last bits depend on the C library: "sin" */
    size_t input_count;
    const epg_host_input_t *inputs; /**< the digital inputs */
    const char *agent;  /**< address of the agent of the target's middleware: HOST:PORT or a terminal; NULL: no agent */
    uint32_t baud_rate; /**< of that terminal */
} epg_host_target_t;

/**
 * Body of main() of a host executable: reads the options of the command line, runs the target, prints a summary.
 * Returns the exit status.
 */
int epg_host_main(const epg_host_target_t *host, int argc, char **argv);

/**
 * Starts the target in real time and returns.  The control loop runs in a new thread, and the communication side in a
 * second one if the target's middleware has a connection.  Returns false, with a message, if this fails, and false if a
 * target is running already.
 */
bool epg_host_start(const epg_host_target_t *host);

/**
 * Stops the threads that epg_host_start() has started, the control thread after its present cycle.  When this returns
 * true, the outputs are safe.  Returns false if the caller is one of these threads, because a thread cannot wait for
 * its own end; the target then goes on.
 */
bool epg_host_stop(void);

#endif
