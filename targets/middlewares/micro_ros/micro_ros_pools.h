/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What libmicroros was built for: its pools are as large as they were when it was compiled.
 */
#ifndef EPG_MICRO_ROS_POOLS_H
#define EPG_MICRO_ROS_POOLS_H

#include <rmw_microxrcedds_c/config.h>

#ifndef RMW_UXRCE_TRANSPORT_CUSTOM
#error "libmicroros was built for a transport of its own: rebuild it with -DRMW_UXRCE_TRANSPORT=custom"
#endif

/* A ping has a frame on its stack, and middleware.yaml says how large that stack is. */
#if UXR_CONFIG_CUSTOM_TRANSPORT_MTU > 2048
#error "libmicroros was built for frames of more than 2048 bytes: rebuild it with -DUCLIENT_CUSTOM_TRANSPORT_MTU=1536"
#endif

/** Bytes around a message in a frame: header of the frame, of the submessage, and whose it is. */
#define EPG_MICRO_ROS_OVERHEAD 16

#endif
