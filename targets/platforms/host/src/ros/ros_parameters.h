/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Parameters of the model that a command line or a file sets, by their names in ROS.
 */
#ifndef EPG_HOST_ROS_PARAMETERS_H
#define EPG_HOST_ROS_PARAMETERS_H

#include "epg/target.h"
#include "ros_arguments.h"

/**
 * Reads and checks all values for the node of `target`, whose names are final.  A later value replaces an earlier one.
 * Returns false after messages.
 */
bool epg_host_ros_read_parameters(const epg_host_ros_t *ros, const epg_target_t *target);

/** Sets the parameters.  Must be called after the start of the control side and before its first cycle. */
void epg_host_ros_set_parameters(const epg_target_t *target);

/** A value in a file or on the command line. */
typedef struct epg_host_ros_value {
    const char *place; /**< "FILE:LINE" for messages; NULL: the argument -p */
    const char *name;  /**< in ROS: "Pan.PID.kp" */
    const char *text;  /**< the value */
    bool quoted;       /**< `text` was in quotation marks: it is a string */
    bool for_all;      /**< the value is for all nodes, and this node need not have a parameter of this name */
} epg_host_ros_value_t;

/** Takes a value.  Returns false after a message. */
bool epg_host_ros_take_value(const epg_host_ros_value_t *value);

/**
 * Reads a file of parameters, and passes those of the node with the full name `node` to epg_host_ros_take_value().
 * Returns false after messages, which have the form of a compiler's.
 */
bool epg_host_ros_read_file(const char *path, const char *node);

/**
 * True if `pattern` names the node with the full name `node`.  A part "*" of the pattern is any one part of the name, and
 * "**" is any number of parts.
 */
bool epg_host_ros_is_node(const char *pattern, const char *node);

#endif
