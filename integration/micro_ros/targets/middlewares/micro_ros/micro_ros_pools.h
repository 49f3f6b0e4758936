/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Checks of the options with which libmicroros was built.  They fix its transport and the sizes of its memory pools.
 */
#ifndef EPG_MICRO_ROS_POOLS_H
#define EPG_MICRO_ROS_POOLS_H

#include <rmw_microxrcedds_c/config.h>

#ifndef RMW_UXRCE_TRANSPORT_CUSTOM
#error "libmicroros was built for another transport: rebuild it with -DRMW_UXRCE_TRANSPORT=custom"
#endif

/* A ping puts a frame on the stack, and middleware.yaml states how large the stack must be. */
#if UXR_CONFIG_CUSTOM_TRANSPORT_MTU > 2048
#error "libmicroros was built for frames of more than 2048 bytes: rebuild it with -DUCLIENT_CUSTOM_TRANSPORT_MTU=1536"
#endif

/** Bytes around a message in a frame: the headers of frame and submessage, and the ids of request and writer. */
#define EPG_MICRO_ROS_OVERHEAD 16

#endif
