/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file of a copy on macOS and others: it is in the folder for temporary files.
 */
#include "posix/copy.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int copy_create(char *name, size_t size)
{
    const char *folder = getenv("TMPDIR");
    snprintf(name, size, "%s/epg_XXXXXX", folder == NULL ? "/tmp" : folder);
    return mkstemp(name);
}

void copy_hide(const char *name)
{
    (void)unlink(name); /* the library stays in memory */
}
