/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Loading of units and plants.
 */
#ifndef EPG_SYSTEM_MODULE_H
#define EPG_SYSTEM_MODULE_H

#include <stdbool.h>

#include "epg/unit.h"

/** A copy of a shared object in memory. */
typedef struct module {
    int file; /**< stays open: dlopen() would find a loaded library of the same name again */
    void *library;
    const void *symbol;
} module_t;

/**
 * Loads a new copy of `file` in `folder`, with variables of its own, and finds `symbol`.  Returns false after a message.
 */
bool module_load(module_t *module, const char *folder, const char *file, const char *symbol);

/** Returns true if `version` is EPG_UNIT_VERSION; else false after a message about `file`. */
bool module_has_version(const char *file, uint32_t version);

/** Removes a copy.  Nothing of it may be used later. */
void module_unload(module_t *module);

#endif
