/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Remapping rules of ROS 2: other names for the node, its namespace and its topics.
 */
#ifndef EPG_HOST_ROS_NAMES_H
#define EPG_HOST_ROS_NAMES_H

#include "epg/target.h"
#include "ros_arguments.h"

/** Bytes of the longest full name of a node, "/namespace/node", with the terminating zero. */
enum { EPG_HOST_ROS_NODE_SIZE = 128 };

/**
 * Applies the rules to the names of `target`, whose store is loaded.  Of several rules for the same name, the first one
 * counts.  Returns false after messages.
 */
bool epg_host_ros_rename(const epg_host_ros_t *ros, epg_target_t *target);

/** Returns the full name of the node, such as "/robot_1/JIWY_node".  It stays valid until the next call. */
const char *epg_host_ros_node(const epg_target_t *target);

/**
 * Finds the prefix "node:" of the argument `text`.  Returns the text after it, and its length in `*length`: 0 if there
 * is no prefix.
 */
const char *epg_host_ros_after_prefix(const char *text, size_t *length);

#endif
