/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The name and the namespace of a target's ROS 2 node.
 *
 * A name is the generated one, unless the user has stored another one on the board (epg/store.h), or has given another
 * one to a program on its command line.  It can contain the
 * word "$serial", which is replaced by the board's serial number; so one firmware gives each board its own name.
 *
 * The rules are those of ROS 2.  A name consists of letters, digits and '_', and does not begin with a digit.  A
 * namespace is "/", or parts that each begin with '/'.  "$serial" must not be at the start of a part, because a serial
 * number can begin with a digit.
 */
#ifndef EPG_NAMES_H
#define EPG_NAMES_H

#include <stdbool.h>
#include <stddef.h>

#include "epg/target.h"

/**
 * Writes `pattern` to `name`, and replaces every "$serial" by epg_port_serial().  Returns false, with a shortened name,
 * if it does not fit into `size` bytes with its terminating zero.
 */
bool epg_names_expand(const char *pattern, char *name, size_t size);

/**
 * Returns true if `text` can be the name of a node.  It must have at most EPG_STORE_NAME_SIZE - 1 characters, also with
 * this board's serial number in it.
 */
bool epg_names_is_node(const char *text);

/** Returns true if `text` can be a namespace, such as "/" or "/fleet/robot_$serial". */
bool epg_names_is_space(const char *text);

/**
 * Returns the name of the node: the given one (`given_node`), otherwise the stored or set one, otherwise the generated
 * one.  "$serial" is not replaced.
 */
const char *epg_names_node(const epg_target_t *target);

/** Returns the namespace of the node in the same way: "" or "/robot1". */
const char *epg_names_space(const epg_target_t *target);

/**
 * Sets the name of the node.  It takes effect at the next start, if it was stored (epg_store_save()).  Returns false,
 * and changes nothing, if `text` is not a name or if the target has no store.  A name equal to the generated one is not
 * stored.  Communication side.
 */
bool epg_names_set_node(const epg_target_t *target, const char *text);

/** Sets the namespace of the node, in the same way.  "/" removes it. */
bool epg_names_set_space(const epg_target_t *target, const char *text);

#endif
