/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * native_sim: what a generated target, the port layer of Zephyr and the simulation know of each other.
 *
 * The target's peripherals are Zephyr's emulated ones.  Between two control cycles a simulated plant turns the shafts of
 * the decoders and sees what the PWM devices and pins put out; setpoints come from a file, and signals go to one, as on
 * the platform `host`, whose code does that.
 */
#ifndef EPG_NATIVE_SIM_H
#define EPG_NATIVE_SIM_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/host.h"
#include "epg/transport.h"
#include "epg/zephyr.h"

/** The target of this image, its plant and what can be recorded; generated. */
extern const epg_host_target_t *const epg_native_sim_target;

/** To the agent of the target's middleware, by UDP or a terminal.  Connected in real time only. */
extern epg_transport_t epg_native_sim_agent;

/** Standard input and output, or a pseudo-terminal, as the command line says; without that, nobody is connected. */
extern epg_transport_t epg_native_sim_terminal;

/* What the port layer tells the simulation.  From the thread that starts the target: */

/** Before the target's peripherals are started; */
void epg_native_sim_starting(void);
/** and after that, before the first cycle. */
void epg_native_sim_started(void);

/* from the control thread: */

/** The cycle of the tick at `tick_ns` (epg_port_time_ns()) is about to run; does not return when the run has ended. */
void epg_native_sim_before_cycle(uint64_t tick_ns);
void epg_native_sim_after_cycle(void);

#endif
