/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * EPG's stream as a custom transport of libmicroros.
 */
#ifndef EPG_MICRO_ROS_TRANSPORT_H
#define EPG_MICRO_ROS_TRANSPORT_H

#include <stdbool.h>

#include "epg/stream.h"

/** Registers the transport.  Must be called once.  Returns false if libmicroros refuses it. */
bool epg_micro_ros_transport_start(const epg_stream_t *stream);

/** Drops the bytes that have arrived: while nobody is connected, so that the next agent's session begins without them. */
void epg_micro_ros_transport_drop(void);

/** Returns true if bytes have been read since the last call. */
bool epg_micro_ros_transport_heard(void);

#endif
