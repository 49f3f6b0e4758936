/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Loading of units and plants.
 */
#include "module.h"

#include <stdio.h>

bool module_load(module_t *module, const char *folder, const char *file, const char *symbol)
{
    *module = (module_t){0};
    const char *problem = module_open(module, folder, file, symbol);
    const uint32_t *version = module->symbol; /* the first member of both structures */
    if (problem == NULL && *version != EPG_UNIT_VERSION) {
        problem = "this file is of another version of EPG: build it again";
    }
    if (problem != NULL) {
        fprintf(stderr, "%s: error: %s\n", file, problem);
    }
    return problem == NULL;
}

void module_unload(module_t *module)
{
    if (module->library != NULL) {
        module_close(module);
    }
    *module = (module_t){0};
}
