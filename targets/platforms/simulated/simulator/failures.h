/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file of failures: a CSV file with the header line `time,target,event`.
 *
 * Times are in seconds since the start of the run, in any order.  An event is one of:
 *
 * | event     | effect                                                                                   |
 * |-----------|------------------------------------------------------------------------------------------|
 * | `die`     | the target loses its power: its outputs get their safe levels                            |
 * | `hang`    | its program stops: no cycles and messages, and the outputs keep their levels             |
 * | `restart` | the target starts again, with the variables of a first start; its plant goes on          |
 * | `stall S` | the next control cycle takes S seconds; ticks in this time have no cycle                      |
 * | `offline` | messages from it and to it are lost                                                      |
 * | `online`  | the end of that                                                                          |
 */
#ifndef EPG_SYSTEM_FAILURES_H
#define EPG_SYSTEM_FAILURES_H

#include "simulate.h"

/**
 * Reads the file `path` into `simulation`.  Returns false after a message `path:line: error: ...` about the first wrong
 * line.
 */
bool failures_read(simulation_t *simulation, const char *path);

#endif
