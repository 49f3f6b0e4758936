/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer's store: a file.
 */
#include "store.h"

#include <stdio.h>

#include "epg/port.h"

static const char *store_path;

void epg_host_store_open(const char *path)
{
    store_path = path;
}

size_t epg_port_store_read(void *data, size_t size)
{
    FILE *file = store_path == NULL ? NULL : fopen(store_path, "rb");
    if (file == NULL) {
        return 0;
    }
    const size_t length = fread(data, 1, size, file);
    fclose(file);
    return length;
}

/**
 * Writes a second file, and renames it when it is complete.  After an interruption, either the old or the new file
 * exists.
 */
bool epg_port_store_write(const void *data, size_t size)
{
    char path[4096];
    const int length = store_path == NULL ? -1 : snprintf(path, sizeof path, "%s.new", store_path);
    FILE *file = length < 0 || (size_t)length >= sizeof path ? NULL : fopen(path, "wb");
    if (file == NULL) {
        return false;
    }
    const bool written = fwrite(data, 1, size, file) == size;
    if (fclose(file) != 0 || !written) {
        remove(path);
        return false;
    }
#if defined(_WIN32)
    remove(store_path); /* rename() does not replace a file there */
#endif
    return rename(path, store_path) == 0;
}
