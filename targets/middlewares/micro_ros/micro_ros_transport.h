/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * EPG's stream as a custom transport of libmicroros.
 */
#ifndef EPG_MICRO_ROS_TRANSPORT_H
#define EPG_MICRO_ROS_TRANSPORT_H

#include <stdbool.h>

#include "epg/stream.h"

/** Once; false: libmicroros has refused it. */
bool epg_micro_ros_transport_start(const epg_stream_t *stream);

/** Whether anything has been read since the last call. */
bool epg_micro_ros_transport_heard(void);

#endif
