/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Reports about a run after its end.
 */
#ifndef EPG_HOST_REPORT_H
#define EPG_HOST_REPORT_H

#include <stdio.h>

#include "loop/run.h"

/** Writes the statistics as one JSON object, with times in seconds.  `docs/host.md` lists the members. */
void epg_host_write_statistics(FILE *file, const epg_host_run_t *run);

/** Prints a summary for the user. */
void epg_host_print_summary(const epg_host_run_t *run);

#endif
