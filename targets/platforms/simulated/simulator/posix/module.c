/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Loading of units and plants on POSIX.
 *
 * dlopen() gives the same library, with the same variables, for the same file.  A copy is therefore loaded, which has no
 * other user.
 */
#include "module.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "posix/copy.h"

/** Copies what is left of one file to another.  Returns false with errno. */
static bool copy(int from, int to)
{
    char part[65536];
    for (;;) {
        const ssize_t length = read(from, part, sizeof part);
        if (length <= 0) {
            return length == 0;
        }
        if (write(to, part, (size_t)length) != length) {
            return false;
        }
    }
}

/** Makes a copy of the file `path` and finds its `name`.  Returns false with errno. */
static bool make_copy(module_t *module, const char *path, char *name, size_t size)
{
    const int from = open(path, O_RDONLY | O_CLOEXEC);
    if (from < 0) {
        return false;
    }
    module->file = copy_create(name, size);
    bool good = module->file >= 0;
    if (good && !copy(from, module->file)) {
        good = false;
        copy_hide(name);
        close(module->file);
    }
    close(from);
    return good;
}

const char *module_open(module_t *module, const char *folder, const char *file, const char *symbol)
{
    static char text[4096];
    char name[4096];
    snprintf(text, sizeof text, "%s/%s", folder, file);
    if (!make_copy(module, text, name, sizeof name)) {
        snprintf(text, sizeof text, "cannot load this file beside the program: %s", strerror(errno));
        return text;
    }
    module->library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    module->symbol = module->library == NULL ? NULL : dlsym(module->library, symbol);
    copy_hide(name);
    return module->symbol == NULL ? dlerror() : NULL;
}

void module_close(module_t *module)
{
    dlclose(module->library);
    close(module->file);
}
