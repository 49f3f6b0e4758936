/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The variables of a model, which get the values of the start of the program before each initialisation of the model.
 *
 * A compiler puts file-scope and function-local static variables into sections of the object file.  Most of them are 0
 * when the program starts.  The others have initial values, or values that C++ constructors have written; these values
 * are kept in RAM.  EPG finds the sections in the model's object files (`epg model-variables`) and generates the table
 * of regions.
 *
 * The address of a section comes from a symbol at its start.  The table therefore needs nothing of a linker script.
 */
#ifndef EPG_VARIABLES_H
#define EPG_VARIABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Marks the symbol at the start of a section.  Weak: the linker leaves out object files that the program does not need. */
#ifdef __ELF__
#define EPG_SECTION_START __attribute__((weak, visibility("hidden")))
#else
#define EPG_SECTION_START __attribute__((weak))
#endif

/** A part of a section. */
typedef struct epg_region {
    unsigned char *section; /**< NULL if the program does not contain the section */
    uint32_t offset;        /**< bytes from the start of the section */
    uint32_t size;          /**< bytes */
    bool zero;              /**< all of it is 0 when the program starts */
} epg_region_t;

typedef struct epg_variables {
    const epg_region_t *regions;
    size_t count;
    uint32_t *kept; /**< the values of all regions that are not 0, each beginning at a whole word */
} epg_variables_t;

/** Keeps the values of the start of the program.  Call it once, before the model runs. */
void epg_variables_keep(const epg_variables_t *variables);

/** Gives all variables the values of the start of the program.  It takes some cycles of the processor per word. */
void epg_variables_restore(const epg_variables_t *variables);

/**
 * Replaces atexit(), and the functions that register destructors of static objects, in the model's object files.  A model
 * has no end, and each start would register its destructors again.  Does nothing; returns 0.
 */
int epg_variables_no_destructor(void);

#endif
