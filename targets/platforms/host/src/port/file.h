/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The files of the store, as the system has them.  Functions that return a number return 0 or the error number.
 */
#ifndef EPG_HOST_FILE_H
#define EPG_HOST_FILE_H

#include <stdbool.h>
#include <stddef.h>

/** Returns true unless `path` is something other than a file, such as a device or a folder. */
bool epg_host_file_is_one(const char *path, bool *exists);

/** Copies the path `name` to `path`; that of the file to which it leads, if it is a link. */
int epg_host_file_resolve(const char *name, char *path, size_t size);

/** Writes the new file `path` to the disk. */
int epg_host_file_write(const char *path, const void *data, size_t size);

/** Replaces the file `path` by the file `from`, with its permissions.  `path` may be changed. */
int epg_host_file_replace(const char *from, char *path);

#endif
