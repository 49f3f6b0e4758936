/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * native_sim: a target in Zephyr, as a program on this computer, with a simulated plant.
 *
 * The target's peripherals are emulated by Zephyr's drivers.  Before each control cycle the plant model is simulated up
 * to that time: it reads the outputs (PWM devices, pins) and moves the shafts of the decoders.  Setpoints come from a
 * file, and signals are recorded to a file.  The code for this is that of the platform `host`.
 *
 * Zephyr's port layer calls the functions below at its start and around each cycle.
 */
#ifndef EPG_NATIVE_SIM_H
#define EPG_NATIVE_SIM_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/host.h"
#include "epg/transport.h"
#include "epg/zephyr.h"

/** The target of this image, with its plant and signals; generated. */
extern const epg_host_target_t *const epg_native_sim_target;

/** The transport to the agent of the target's middleware, by UDP or a terminal.  It is connected in real time only. */
extern epg_transport_t epg_native_sim_agent;

/**
 * The transport by standard input and output, or by a pseudo-terminal.  An option of the command line chooses one of
 * them; without such an option it is never connected.
 */
extern epg_transport_t epg_native_sim_terminal;

/** Called before the target's peripherals are started, by the thread that starts the target.  Starts the plant. */
void epg_native_sim_starting(void);
/** Called after the target's peripherals were started and before the first cycle, by the same thread. */
void epg_native_sim_started(void);

/**
 * Called by the control thread before the cycle of the tick at `tick_ns`, a time of epg_port_time_ns().  Simulates the
 * plant up to this time.  At the end of the run it ends the program and does not return.
 */
void epg_native_sim_before_cycle(uint64_t tick_ns);
/** Called by the control thread after a cycle.  Applies the outputs to the plant, and records the signals. */
void epg_native_sim_after_cycle(void);

#endif
