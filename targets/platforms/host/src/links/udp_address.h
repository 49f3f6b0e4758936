/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The text of a UDP address: `ADDRESS:PORT`, with an IPv6 address in brackets, or only `PORT`.
 */
#ifndef EPG_HOST_UDP_ADDRESS_H
#define EPG_HOST_UDP_ADDRESS_H

#include <stdbool.h>

enum { EPG_HOST_UDP_NAME = 256 };

typedef struct epg_host_udp_address {
    char host[EPG_HOST_UDP_NAME]; /**< without brackets; empty: only a port was given */
    const char *port;             /**< decimal digits, within the text */
} epg_host_udp_address_t;

/** Splits `text`.  Returns false if it does not have this form. */
bool epg_host_udp_address_split(const char *text, epg_host_udp_address_t *address);

#endif
