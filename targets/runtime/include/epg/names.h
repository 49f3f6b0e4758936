/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Names of a node: as generated or as stored, with the board's serial number in the place of "$serial".
 *
 * The rules are those of ROS 2: letters, digits and '_', no digit first; a namespace is "/" or parts that begin with '/'.
 * "$serial" may stand behind the first character of a part, because serial numbers begin with digits too.
 */
#ifndef EPG_NAMES_H
#define EPG_NAMES_H

#include <stdbool.h>
#include <stddef.h>

#include "epg/target.h"

/**
 * Writes `pattern` to `name` with every "$serial" replaced by epg_port_serial(); a name that does not fit into `size`
 * bytes with its terminating zero is cut.  Returns whether it fitted.
 */
bool epg_names_expand(const char *pattern, char *name, size_t size);

/** Whether `text` can name a node: with this board's serial number, EPG_STORE_NAME_SIZE - 1 characters at most. */
bool epg_names_is_node(const char *text);

/** Whether `text` can be a namespace: "/", or such as "/fleet/robot_$serial". */
bool epg_names_is_space(const char *text);

/** The name of the node, "$serial" not yet replaced: as stored or set, else as generated. */
const char *epg_names_node(const epg_target_t *target);

/** Its namespace, the same: "" or "/robot1". */
const char *epg_names_space(const epg_target_t *target);

/**
 * Changes a name from the next start on, if it is saved (epg_store_save()); false, and nothing happens, if it is none or
 * if the target has no store.  What is as generated is not stored.  Communication side.
 */
bool epg_names_set_node(const epg_target_t *target, const char *text);
bool epg_names_set_space(const epg_target_t *target, const char *text);

#endif
