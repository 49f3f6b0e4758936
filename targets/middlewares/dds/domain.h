/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Which DDS domain, and who of its network is looked for: as the environment says it to ROS 2.
 */
#ifndef EPG_DDS_DOMAIN_H
#define EPG_DDS_DOMAIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Bytes that CycloneDDS's configuration may have, with the terminating zero. */
#define EPG_DDS_CONFIGURATION_SIZE 16384

/**
 * The domain: `configured` unless that is EPG_DOMAIN_DEFAULT, then ROS_DOMAIN_ID, 0 if that is not set.  False, with a
 * message, if ROS_DOMAIN_ID is none.
 */
bool epg_dds_domain(uint8_t configured, uint32_t *domain);

/**
 * CycloneDDS's configuration: what rmw_cyclonedds of ROS 2 Jazzy makes of ROS_AUTOMATIC_DISCOVERY_RANGE,
 * ROS_STATIC_PEERS and ROS_LOCALHOST_ONLY, then CYCLONEDDS_URI, which may overrule it.  False, with a message, if a
 * variable has no meaning or is too long.
 */
bool epg_dds_configuration(char *text, size_t size);

#endif
