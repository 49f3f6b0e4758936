/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The port layer's store: a file.
 */
#include "store.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "epg/port.h"
#include "file.h"

static const char *store_path;

void epg_host_store_open(const char *path)
{
    store_path = path;
}

static const char *because(int error)
{
    static char text[128];
    snprintf(text, sizeof text, "the file of --store cannot be written: %s", strerror(error));
    return text;
}

size_t epg_port_store_read(void *data, size_t size)
{
    bool exists;
    FILE *file = store_path == NULL || !epg_host_file_is_one(store_path, &exists) ? NULL : fopen(store_path, "rb");
    if (file == NULL) {
        return 0;
    }
    const size_t length = fread(data, 1, size, file);
    fclose(file);
    return length;
}

/**
 * Writes a second file, and renames it when it is on the disk.  After an interruption, either the old or the new file
 * exists.
 */
const char *epg_port_store_write(const void *data, size_t size)
{
    enum { LONGEST = 4096 };
    char path[LONGEST];
    char fresh[LONGEST + sizeof ".new"];
    bool exists;
    if (store_path == NULL) {
        return "this program was started without --store FILE";
    }
    if (!epg_host_file_is_one(store_path, &exists)) {
        return "the path of --store is not a file, but a folder or a device";
    }
    int error = epg_host_file_resolve(store_path, path, sizeof path);
    if (error != 0) {
        return because(error);
    }
    snprintf(fresh, sizeof fresh, "%s.new", path);
    error = epg_host_file_write(fresh, data, size);
    if (error == 0) {
        error = epg_host_file_replace(fresh, path);
    }
    if (error != 0) {
        (void)remove(fresh);
        return because(error);
    }
    return NULL;
}

void epg_host_store_tell(const epg_store_t *store)
{
    bool exists;
    if (store_path == NULL || store == NULL) {
        return;
    }
    if (!epg_host_file_is_one(store_path, &exists)) {
        fprintf(stderr, "%s: warning: this is not a file, but a folder or a device: nothing can be stored\n",
                store_path);
        return;
    }
    if (store->parameters == NULL) {
        return;
    }
    const char *all = NULL;
    switch (store->parameters->stored) {
    case EPG_STORED_DAMAGED:
        all = "the stored parameters are damaged";
        break;
    case EPG_STORED_FOR_OTHER:
        all = "the stored parameters are those of another model";
        break;
    case EPG_STORED_NOTHING: /* an empty file, or one that cannot be read */
        all = exists ? "there are no stored parameters in this file" : NULL;
        break;
    default:
        break;
    }
    if (all != NULL) {
        fprintf(stderr, "%s: warning: %s: all have their generated values, and 'save' replaces the file\n", store_path,
                all);
    }
    for (size_t i = 0; epg_store_refused(store, i) != NULL; i++) {
        fprintf(stderr, "%s: warning: the stored value of %s is outside of its limits: it has its generated value\n",
                store_path, epg_store_refused(store, i));
    }
}
