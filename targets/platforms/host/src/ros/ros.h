/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The effect of the arguments after `--ros-args` on a target, which must know its stored names.
 */
#ifndef EPG_HOST_ROS_H
#define EPG_HOST_ROS_H

#include "epg/target.h"
#include "ros_arguments.h"

/**
 * Applies the rules to `target`: names of node and topics, and the log level.  Checks the parameters, which
 * epg_host_ros_set_parameters() sets later.  Loads the target's store for this.  Returns false after messages.
 */
bool epg_host_ros_prepare(const epg_host_ros_t *ros, epg_target_t *target);

#endif
