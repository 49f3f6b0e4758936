/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file of a copy that is loaded.  It stays open: dlopen() would find a loaded library of the same file again.
 */
#ifndef EPG_SYSTEM_COPY_H
#define EPG_SYSTEM_COPY_H

#include <stddef.h>

/** Makes an empty file that no other program uses, and finds its `name`.  Returns its descriptor, or -1 with errno. */
int copy_create(char *name, size_t size);

/** Called when the copy is loaded, or has failed: the file is gone when it is closed. */
void copy_hide(const char *name);

#endif
