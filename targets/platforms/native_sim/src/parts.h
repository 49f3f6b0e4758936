/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that the files of the simulation call in each other.
 */
#ifndef EPG_NATIVE_SIM_PARTS_H
#define EPG_NATIVE_SIM_PARTS_H

#include <stdbool.h>

#include "epg/native_sim.h"
#include "loop/run.h"
#include "program/options.h"

/* options.c ------------------------------------------------------------------------------------------------------ */

/** The options of the command line.  `realtime` is true, too, if no duration was given. */
extern epg_host_options_t epg_native_sim_options;

/** The events of the setpoint file. */
extern epg_host_events_t epg_native_sim_events;

/* signals.c ------------------------------------------------------------------------------------------------------ */

/** Returns false, with a message, if a decoder, PWM output or pin of the target is not emulated. */
bool epg_native_sim_all_emulated(void);

/** From now on a change of a shaft's position produces counts.  Before this call it only sets the initial position. */
void epg_native_sim_shafts_turn(void);

/** Sets the levels of all driven pins again: a pin that was not an input yet has not got its level. */
void epg_native_sim_drive_pins(void);

/* transports.c --------------------------------------------------------------------------------------------------- */

/** Opens the transports that the options request.  Returns DONE, or after a message the exit status. */
int epg_native_sim_open_transports(void);
void epg_native_sim_close_transports(void);

/** Reports on stderr when the connection to the agent was made or lost. */
void epg_native_sim_tell_connection(void);

/** True if the run has no duration, its console is standard input, and this has ended. */
bool epg_native_sim_input_ended(void);

/*
 * interrupt.c, which is not a part of the image but of the native simulator around it ---------------------------------
 */

/** From now on the first Ctrl-C or SIGTERM sets `*flag` to 1, and a second one ends the program. */
void epg_native_sim_catch_interrupts(volatile int *flag);

#endif
