/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middleware `dds`: ROS 2 without an agent.  The program itself is a DDS participant, with CycloneDDS.  It is for
 * computers, not for microcontrollers.
 *
 * To other ROS 2 programs it looks like a node with rmw_cyclonedds: topics, types, QoS, type hashes and the node's name
 * are the same.  The environment variables CYCLONEDDS_URI, ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE,
 * ROS_STATIC_PEERS and ROS_LOCALHOST_ONLY have the same meaning as in ROS 2 Jazzy.
 *
 * It allocates memory from the heap when it starts and for each message, as CycloneDDS itself does.
 */
#ifndef EPG_DDS_H
#define EPG_DDS_H

#include "epg/middleware.h"

extern const epg_middleware_t epg_dds;

#endif
