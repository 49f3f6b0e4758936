/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What programs are told about a simulation: the names of its targets, and their states at its end.
 */
#ifndef EPG_SYSTEM_REPORT_H
#define EPG_SYSTEM_REPORT_H

#include <stdio.h>

#include "simulate.h"

/**
 * Prints the names that scenarios may use.  The line `system,name` comes first, then the signals of the system's plant.
 * For each target, the line `target,name` comes before the lines of epg_host_print_interface().  A line `connected,name`
 * names one of its topics that another target sends.
 */
void report_interface(const simulation_t *simulation);

/**
 * Writes the states of all targets and the last outputs of the system's plant as one JSON object.  The counts of a target
 * are those since its last start.
 */
void report_statistics(const simulation_t *simulation, FILE *file);

#endif
