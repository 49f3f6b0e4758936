/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Loading of units and plants on Windows.
 *
 * Each target has files of its own, and each is loaded once at a time.  A library that is unloaded and loaded again has its
 * first values, so no copy is needed.
 */
#include "module.h"

#include <stdint.h>
#include <stdio.h>

#include <windows.h>

const char *module_open(module_t *module, const char *folder, const char *file, const char *symbol)
{
    static char problem[128];
    (void)folder; /* Windows looks in the folder of the program first, whatever characters its path has */
    if (GetModuleHandleA(file) != NULL) {
        return "this file stays in memory with its old values, so its target cannot restart";
    }
    module->library = LoadLibraryA(file);
    if (module->library == NULL) {
        snprintf(problem, sizeof problem, "cannot load this file beside the program: error %lu of Windows",
                 GetLastError());
        return problem;
    }
    module->symbol = (const void *)(uintptr_t)GetProcAddress(module->library, symbol);
    return module->symbol != NULL ? NULL : "this file is not a part of a simulation: build it again";
}

void module_close(module_t *module)
{
    FreeLibrary(module->library);
}
