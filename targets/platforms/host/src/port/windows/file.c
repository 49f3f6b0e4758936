/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Files of Windows.
 */
#include "port/file.h"

#include <errno.h>
#include <stdio.h>

bool epg_host_file_is_one(const char *path, bool *exists)
{
    FILE *file = fopen(path, "rb");
    *exists = file != NULL;
    if (file != NULL) {
        fclose(file);
    }
    return true;
}

int epg_host_file_write(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (file == NULL) {
        return errno;
    }
    errno = 0;
    const bool written = fwrite(data, 1, size, file) == size;
    return fclose(file) == 0 && written ? 0 : errno != 0 ? errno : EIO;
}

int epg_host_file_replace(const char *from, char *path)
{
    remove(path); /* rename() does not replace a file there */
    return rename(from, path) == 0 ? 0 : errno;
}

int epg_host_file_resolve(const char *name, char *path, size_t size)
{
    const int length = snprintf(path, size, "%s", name);
    return length >= 0 && (size_t)length < size ? 0 : ENAMETOOLONG;
}
