/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The DDS domain and the discovery of other nodes, from the environment variables of ROS 2.
 */
#ifndef EPG_DDS_DOMAIN_H
#define EPG_DDS_DOMAIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Largest size of CycloneDDS's configuration in bytes, with the terminating zero. */
#define EPG_DDS_CONFIGURATION_SIZE 16384

/**
 * Gives the domain: `configured`, or ROS_DOMAIN_ID if `configured` is EPG_DOMAIN_DEFAULT, or 0 if that is not set.
 * Prints a message and returns false if ROS_DOMAIN_ID is not a domain.
 */
bool epg_dds_domain(uint8_t configured, uint32_t *domain);

/**
 * Writes CycloneDDS's configuration, as rmw_cyclonedds of ROS 2 Jazzy does.  The first part follows from
 * ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and ROS_LOCALHOST_ONLY.  The second part is CYCLONEDDS_URI, which can
 * override the first.  Prints a message and returns false if a variable is invalid or too long.
 */
bool epg_dds_configuration(char *text, size_t size);

#endif
