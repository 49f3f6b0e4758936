/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the parts of the simulation ask of each other.
 */
#ifndef EPG_NATIVE_SIM_PARTS_H
#define EPG_NATIVE_SIM_PARTS_H

#include <stdbool.h>

#include "epg/native_sim.h"
#include "options.h"
#include "run.h"

/** Exit status, as of a host executable. */
enum { DONE = 0, FAILED = 1, WRONG_INPUT = 2, INTERRUPTED = 130 };

/* options.c ------------------------------------------------------------------------------------------------------ */

/** What the command line says; `realtime` unless only simulated time was asked for. */
extern epg_host_options_t epg_native_sim_options;

/** What the setpoint file says. */
extern epg_host_events_t epg_native_sim_events;

/* signals.c ------------------------------------------------------------------------------------------------------ */

/** False, with a message, when a decoder, PWM output or pin of the target is not an emulated one. */
bool epg_native_sim_all_emulated(void);

/** From now on shafts turn; before, they are only where they are. */
void epg_native_sim_shafts_turn(void);

/** Drives the pins again that were driven before they were inputs. */
void epg_native_sim_drive_pins(void);

/* transports.c --------------------------------------------------------------------------------------------------- */

/** Opens what the command line asks for; DONE, or the exit status after a message. */
int epg_native_sim_open_transports(void);
void epg_native_sim_close_transports(void);

/** Says on stderr what has become of the connection to the agent. */
void epg_native_sim_tell_connection(void);

/** Whether standard input was the console, and has ended. */
bool epg_native_sim_input_ended(void);

/* interrupt.c, which is no part of the image but of the program around it -------------------------------------------- */

/** From now on an interrupt (Ctrl-C, SIGTERM) sets `*flag`; a second one ends the program. */
void epg_native_sim_catch_interrupts(volatile int *flag);

#endif
