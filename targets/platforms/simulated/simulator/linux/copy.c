/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file of a copy on Linux: it is in memory.
 */
#define _GNU_SOURCE

#include "posix/copy.h"

#include <stdio.h>
#include <sys/mman.h>

int copy_create(char *name, size_t size)
{
    const int file = memfd_create("epg", MFD_CLOEXEC);
    snprintf(name, size, "/proc/self/fd/%d", file);
    return file;
}

void copy_hide(const char *name)
{
    (void)name; /* nobody else sees it */
}
