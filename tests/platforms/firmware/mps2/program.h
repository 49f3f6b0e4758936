/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The two parts of a program: free_running.c or restart.c, and main_bare.c or main_freertos.c.
 */
#ifndef PROGRAM_H
#define PROGRAM_H

/** Starts the board and the target. */
void program_start(void);

/** One turn of the main loop, or of the task. */
void program_turn(void);

#endif
