/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middleware `micro_ros`: ROS 2 through an agent, with rcl and micro-ROS's library libmicroros.
 *
 * epg/node.h serialises the messages, and libmicroros carries their bytes.  Some calls of libmicroros wait for the
 * agent; docs/micro-ros.md lists them with their longest times.  An executable can contain one such node.
 */
#ifndef EPG_MICRO_ROS_H
#define EPG_MICRO_ROS_H

#include "epg/middleware.h"
#include "micro_ros_options.h"

extern const epg_middleware_t epg_micro_ros;

#endif
