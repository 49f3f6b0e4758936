/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Reports about a target and, after its end, about a run.
 */
#ifndef EPG_HOST_REPORT_H
#define EPG_HOST_REPORT_H

#include <stdio.h>

#include "run.h"

/** Prints the names that scenarios and setpoint files may use, for programs: a line `kind,name` for each name. */
void epg_host_print_interface(const epg_host_target_t *host);

/** Writes the statistics as one JSON object, with times in seconds.  `docs/host.md` lists the members. */
void epg_host_write_statistics(FILE *file, const epg_host_run_t *run);

/** Prints a summary for the user. */
void epg_host_print_summary(const epg_host_run_t *run);

#endif
