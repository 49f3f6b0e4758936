/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The files that a run writes.
 */
#include "files.h"

#include <errno.h>
#include <stdatomic.h>
#include <string.h>

static atomic_int flush_error; /* the error number of the first flush that failed; 0: none */

/** Opens `path` for writing.  Returns true and does nothing if `path` is NULL. */
static bool open_file(const char *path, FILE **file)
{
    if (path == NULL) {
        return true;
    }
    *file = fopen(path, "wb"); /* binary: the same bytes on each system */
    if (*file == NULL) {
        fprintf(stderr, "%s: error: cannot write this file: %s\n", path, strerror(errno));
    }
    return *file != NULL;
}

static bool close_file(const char *path, FILE *file)
{
    if (file == NULL) {
        return true;
    }
    const bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed) {
        const int error = errno != 0 ? errno : atomic_load(&flush_error);
        fprintf(stderr, "%s: error: cannot write this file: %s\n", path, error != 0 ? strerror(error) : "failed");
        return false;
    }
    return true;
}

bool epg_host_files_open(epg_host_files_t *files, const epg_host_options_t *options)
{
    *files = (epg_host_files_t){0};
    return open_file(options->topics, &files->topics) && open_file(options->trace, &files->trace) &&
           open_file(options->statistics, &files->statistics);
}

void epg_host_files_flush(FILE *file)
{
    errno = 0;
    int none = 0;
    if (fflush(file) != 0) {
        (void)atomic_compare_exchange_strong(&flush_error, &none, errno);
    }
}

bool epg_host_files_close(epg_host_files_t *files, const epg_host_options_t *options)
{
    errno = 0;
    const bool topics = close_file(options->topics, files->topics);
    const bool trace = close_file(options->trace, files->trace);
    const bool statistics = close_file(options->statistics, files->statistics);
    *files = (epg_host_files_t){0};
    return topics && trace && statistics;
}
