/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The text of a UDP address.
 */
#include "udp_address.h"

#include <stddef.h>
#include <string.h>

static bool is_port(const char *text)
{
    unsigned long port = 0;
    size_t digits = 0;
    for (; text[digits] >= '0' && text[digits] <= '9' && digits < 6; digits++) {
        port = port * 10 + (unsigned long)(text[digits] - '0');
    }
    return digits > 0 && text[digits] == '\0' && port <= 65535;
}

bool epg_host_udp_address_split(const char *text, epg_host_udp_address_t *address)
{
    const char *colon = strrchr(text, ':');
    address->host[0] = '\0';
    address->port = colon == NULL ? text : colon + 1;
    if (!is_port(address->port)) {
        return false;
    }
    if (colon == NULL) {
        return true;
    }
    size_t length = (size_t)(colon - text);
    const bool bracketed = length > 2 && text[0] == '[' && text[length - 1] == ']'; /* [::1]:7000 */
    const char *host = bracketed ? text + 1 : text;
    length -= bracketed ? 2U : 0U;
    if (length == 0 || length >= sizeof address->host) {
        return false;
    }
    memcpy(address->host, host, length);
    address->host[length] = '\0';
    return true;
}
