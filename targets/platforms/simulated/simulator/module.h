/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Loading of units and plants.
 */
#ifndef EPG_SYSTEM_MODULE_H
#define EPG_SYSTEM_MODULE_H

#include <stdbool.h>

#include "epg/unit.h"

/** A shared object in memory, with variables of its own. */
typedef struct module {
    void *library;
    const void *symbol;
    int file; /**< of the copy that is loaded; not on Windows */
} module_t;

/**
 * Loads `file` of the folder of the program, with variables that have their first values, and finds `symbol`.  Returns
 * false after a message, also if it is of another version.
 */
bool module_load(module_t *module, const char *folder, const char *file, const char *symbol);

/** Removes it from memory.  Nothing of it may be used later. */
void module_unload(module_t *module);

/* Of the system ------------------------------------------------------------------------------------------------- */

/** Loads `file` and finds `symbol` for module_load().  Returns NULL, or what is wrong. */
const char *module_open(module_t *module, const char *folder, const char *file, const char *symbol);

/** Unloads a module that module_open() has loaded. */
void module_close(module_t *module);

#endif
