/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The two parts of a program: lockstep.c or free_running.c, and main_bare.c or main_freertos.c.
 */
#ifndef PROGRAM_H
#define PROGRAM_H

#include <stdbool.h>

/** The main loop sleeps when there is nothing to do. */
extern const bool program_sleeps;

/** Starts the board and the target. */
void program_start(void);

/** One turn of the main loop, or of the task. */
void program_turn(void);

#endif
