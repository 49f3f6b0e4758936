/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Loading of units and plants.
 *
 * dlopen() gives the same library, with the same variables, for the same file.  Each copy is therefore loaded from a
 * file in memory of its own (memfd_create), which has no other user.
 */
#define _GNU_SOURCE

#include "module.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

/** Copies the file `path` to a new file in memory.  Returns its descriptor, or -1 with errno. */
static int copy_of(const char *path)
{
    const int from = open(path, O_RDONLY | O_CLOEXEC);
    struct stat facts;
    if (from < 0 || fstat(from, &facts) != 0) {
        return -1;
    }
    const int to = memfd_create("epg", MFD_CLOEXEC);
    off_t left = facts.st_size;
    while (to >= 0 && left > 0) {
        const ssize_t sent = sendfile(to, from, NULL, (size_t)left);
        if (sent <= 0) {
            break;
        }
        left -= sent;
    }
    close(from);
    if (to >= 0 && left > 0) {
        close(to);
        return -1;
    }
    return to;
}

bool module_load(module_t *module, const char *folder, const char *file_name, const char *symbol)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, file_name);
    *module = (module_t){0};
    const int file = copy_of(path);
    if (file < 0) {
        fprintf(stderr, "%s: error: cannot read this file: %s\n", path, strerror(errno));
        return false;
    }
    char name[64];
    snprintf(name, sizeof name, "/proc/self/fd/%d", file);
    module->library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    module->file = file;
    module->symbol = module->library == NULL ? NULL : dlsym(module->library, symbol);
    if (module->symbol == NULL) {
        fprintf(stderr, "%s: error: %s\n", path, dlerror());
        return false;
    }
    return true;
}

bool module_has_version(const char *file, uint32_t version)
{
    if (version != EPG_UNIT_VERSION) {
        fprintf(stderr, "%s: error: this file is of another version of EPG: build it again\n", file);
    }
    return version == EPG_UNIT_VERSION;
}

void module_unload(module_t *module)
{
    if (module->library != NULL) {
        dlclose(module->library);
        close(module->file);
    }
    *module = (module_t){0};
}
