/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * ROS 2 without an agent: the program is a DDS participant, by CycloneDDS.  For computers, not for microcontrollers.
 *
 * What others of its network see is what a ROS 2 node with rmw_cyclonedds shows: topics, types, QoS, type hashes, and
 * the node's name.  CYCLONEDDS_URI, ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and
 * ROS_LOCALHOST_ONLY mean what they mean to ROS 2 Jazzy.
 *
 * Takes memory from the heap when it starts and for each message, as CycloneDDS does anyway.
 */
#ifndef EPG_DDS_H
#define EPG_DDS_H

#include "epg/middleware.h"

extern const epg_middleware_t epg_dds;

#endif
