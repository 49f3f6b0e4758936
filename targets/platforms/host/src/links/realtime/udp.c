/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A link by UDP.
 */
#define _POSIX_C_SOURCE 200809L

#include "links/link.h"

#include <stdio.h>
#include <stdlib.h>

#include "links/udp_address.h"
#include "sockets.h"

enum { LARGEST_PACKET = 65507 };

bool epg_host_link_is_address(const char *text)
{
    epg_host_udp_address_t parts;
    return epg_host_udp_address_split(text, &parts) && parts.host[0] != '\0' && strtoul(parts.port, NULL, 10) > 0;
}

bool epg_host_link_open(epg_host_link_t *link, const char *agent, uint32_t baud_rate)
{
    if (agent[0] != '/' && epg_host_link_is_address(agent)) {
        return epg_host_link_udp(link, agent);
    }
    return epg_host_link_serial(link, agent, baud_rate);
}

static bool connected(void *context)
{
    const epg_host_link_t *link = context;
    return link->file >= 0;
}

static size_t read_packet(void *context, void *data, size_t size)
{
    const epg_host_link_t *link = context;
    long count = epg_host_socket_receive(link->file, data, size, NULL, NULL);
    if (count < 0 && epg_host_socket_was_refused(epg_host_socket_error())) {
        count = epg_host_socket_receive(link->file, data, size, NULL, NULL);
    }
    return count > 0 ? ((size_t)count < size ? (size_t)count : size) : 0;
}

static size_t write_packet(void *context, const void *data, size_t size)
{
    const epg_host_link_t *link = context;
    long count = epg_host_socket_send(link->file, data, size, NULL, 0);
    if (count < 0 && epg_host_socket_was_refused(epg_host_socket_error())) {
        count = epg_host_socket_send(link->file, data, size, NULL, 0);
    }
    return count > 0 ? (size_t)count : 0;
}

static size_t writable(void *context)
{
    (void)context;
    return LARGEST_PACKET; /* a packet that the system cannot take is lost; UDP permits this */
}

/** Makes a socket that is connected to the first address that can be reached; -1 if there is none. */
static int connect_to(const struct addrinfo *address)
{
    for (; address != NULL; address = address->ai_next) {
        const int file = epg_host_socket_open(address);
        if (file >= 0 && epg_host_socket_connect(file, address)) {
            return file;
        }
        if (file >= 0) {
            epg_host_socket_close(file);
        }
    }
    return -1;
}

bool epg_host_link_udp(epg_host_link_t *link, const char *address)
{
    epg_host_udp_address_t parts;
    (void)epg_host_udp_address_split(address, &parts);
    const struct addrinfo wanted = {.ai_socktype = SOCK_DGRAM};
    struct addrinfo *found = NULL;
    *link = (epg_host_link_t){
        .stream = {.connected = connected,
                   .read = read_packet,
                   .write = write_packet,
                   .writable = writable,
                   .context = link,
                   .datagrams = true},
        .file = -1,
    };
    epg_host_sockets_start();
    const int error = getaddrinfo(parts.host, parts.port, &wanted, &found);
    if (error != 0) {
        fprintf(stderr, "error: the agent's host '%s' was not found: %s\n", parts.host, gai_strerror(error));
        return false;
    }
    link->file = connect_to(found);
    if (link->file < 0) {
        fprintf(stderr, "error: the agent's address '%s' cannot be reached: %s\n", address,
                epg_host_socket_text(epg_host_socket_error()));
    }
    freeaddrinfo(found);
    return link->file >= 0;
}
