/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The arguments after `--ros-args`, by which `ros2 run` and launch files set up a node:
 *
 *     jiwy_host --ros-args -r __ns:=/robot_1 -r pan_subscriber:=/joystick/pan -p Pan.PID.kp:=2.5 -- --quiet
 *
 * Source of the grammar: design.ros2.org, "ROS Command Line Arguments"; rcl 9.2, arguments.c.
 */
#ifndef EPG_HOST_ROS_ARGUMENTS_H
#define EPG_HOST_ROS_ARGUMENTS_H

#include <stdbool.h>
#include <stddef.h>

/** Largest number of rules on a command line. */
enum { EPG_HOST_ROS_RULES = 128 };

typedef enum epg_host_ros_kind {
    EPG_HOST_ROS_REMAP,          /**< -r FROM:=TO */
    EPG_HOST_ROS_PARAMETER,      /**< -p NAME:=VALUE */
    EPG_HOST_ROS_PARAMETER_FILE, /**< --params-file FILE */
    EPG_HOST_ROS_LOG_LEVEL,      /**< --log-level LEVEL */
    EPG_HOST_ROS_NO_LOG,         /**< --disable-stdout-logs */
    EPG_HOST_ROS_ENCLAVE,        /**< --enclave PATH */
    EPG_HOST_ROS_IGNORED         /**< without effect for this program */
} epg_host_ros_kind_t;

typedef struct epg_host_ros_rule {
    epg_host_ros_kind_t kind;
    const char *text;
} epg_host_ros_rule_t;

typedef struct epg_host_ros {
    bool given; /**< `--ros-args` was given, perhaps without rules */
    size_t count;
    epg_host_ros_rule_t rules[EPG_HOST_ROS_RULES]; /**< in the order of the command line */
} epg_host_ros_t;

/**
 * Reads the arguments after argv[*i], which is "--ros-args", up to "--" or to the last one.  Leaves `*i` at the last
 * argument that it has read.  Returns false after a message.
 */
bool epg_host_ros_take(epg_host_ros_t *ros, int argc, char **argv, int *i);

#endif
