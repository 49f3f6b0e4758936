/**
 * @file
 * Names of a node: as generated or as stored, with the board's serial number in the place of "$serial".
 */
#ifndef EPG_NAMES_H
#define EPG_NAMES_H

#include <stdbool.h>
#include <stddef.h>

/**
 * Writes `pattern` to `name` with every "$serial" replaced by epg_port_serial(); a name that does not fit into `size`
 * bytes with its terminating zero is cut.  Returns whether it fitted.
 */
bool epg_names_expand(const char *pattern, char *name, size_t size);

#endif
