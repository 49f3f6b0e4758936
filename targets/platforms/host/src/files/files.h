/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The files that a run writes.
 */
#ifndef EPG_HOST_FILES_H
#define EPG_HOST_FILES_H

#include <stdbool.h>
#include <stdio.h>

#include "program/options.h"

/** The open files.  NULL if a file is not wanted. */
typedef struct epg_host_files {
    FILE *topics;
    FILE *trace;
    FILE *statistics;
} epg_host_files_t;

/** Opens the files that `options` name.  Returns false, with a message, if one cannot be opened. */
bool epg_host_files_open(epg_host_files_t *files, const epg_host_options_t *options);

/** Writes what is buffered for `file` to the disk.  Any thread; the cause of a failure is reported when it is closed. */
void epg_host_files_flush(FILE *file);

/** Closes all open files.  Returns false, with a message, if one could not be written. */
bool epg_host_files_close(epg_host_files_t *files, const epg_host_options_t *options);

#endif
