/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What is said about a target, and about a run after its end.
 */
#ifndef EPG_HOST_REPORT_H
#define EPG_HOST_REPORT_H

#include <stdio.h>

#include "run.h"

/** Prints the names that scenarios and setpoint files may use, one line `kind,name` each, for programs. */
void epg_host_print_interface(const epg_host_target_t *host);

/** Writes the statistics as one JSON object; times in seconds.  `docs/host.md` lists the members. */
void epg_host_write_statistics(FILE *file, const epg_host_run_t *run);

/** Prints a short table for people. */
void epg_host_print_summary(const epg_host_run_t *run);

#endif
