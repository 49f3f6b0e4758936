/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The socket of the console by UDP, and the addresses of its users.
 */
#define _POSIX_C_SOURCE 200809L

#include "udp_peer.h"

#include <stdio.h>
#include <string.h>

#include "links/udp_address.h"

bool epg_host_peer_equal(const epg_host_peer_t *one, const epg_host_peer_t *other)
{
    return one->size == other->size && memcmp(&one->address, &other->address, (size_t)one->size) == 0;
}

void epg_host_peer_name(const epg_host_peer_t *peer, char text[EPG_HOST_PEER_NAME])
{
    char host[EPG_HOST_PEER_NAME - sizeof "[]:65535"];
    char port[8];
    if (getnameinfo((const struct sockaddr *)&peer->address, peer->size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
        host[0] = '\0';
        port[0] = '\0';
    }
    snprintf(text, EPG_HOST_PEER_NAME, strchr(host, ':') != NULL ? "[%s]:%s" : "%s:%s", host, port);
}

bool epg_host_peer_send(int file, const epg_host_peer_t *peer, const void *data, size_t size)
{
    return epg_host_socket_send(file, data, size, &peer->address, peer->size) >= 0 ||
           !epg_host_socket_is_full(epg_host_socket_error());
}

long epg_host_peer_receive(int file, epg_host_peer_t *peer, void *data, size_t size)
{
    memset(peer, 0, sizeof *peer);
    peer->size = sizeof peer->address;
    return epg_host_socket_receive(file, data, size, &peer->address, &peer->size);
}

static void refuse(const char *address, const char *reason, const char *hint)
{
    fprintf(stderr, "error: --console-udp %s: %s\nhint: %s\n", address, reason, hint);
}

int epg_host_peer_listen(const char *address)
{
    const struct addrinfo wanted = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_PASSIVE};
    epg_host_udp_address_t parts;
    (void)epg_host_udp_address_split(address, &parts);
    const char *host = parts.host[0] != '\0' ? parts.host : "127.0.0.1";
    struct addrinfo *found = NULL;
    epg_host_sockets_start();
    const int error = getaddrinfo(host, parts.port, &wanted, &found);
    if (error != 0) {
        refuse(address, gai_strerror(error), "give an address of this computer, for example 127.0.0.1:7000");
        return -1;
    }
    const int file = epg_host_socket_open(found);
    const bool bound = file >= 0 && epg_host_socket_bind(file, found);
    const int reason = epg_host_socket_error();
    freeaddrinfo(found);
    if (bound) {
        return file;
    }
    if (file >= 0) {
        epg_host_socket_close(file);
    }
    if (epg_host_socket_is_taken(reason)) {
        refuse(address, "another program uses this port", "end it, or choose another port");
    } else if (epg_host_socket_is_foreign(reason)) {
        refuse(address, "this computer does not have this address", "'ip address' lists its addresses");
    } else {
        refuse(address, epg_host_socket_text(reason), "choose an address of this computer and a port above 1023");
    }
    return -1;
}

static bool get_own(int file, epg_host_peer_t *own)
{
    own->size = sizeof own->address;
    return epg_host_socket_name(file, &own->address, &own->size);
}

bool epg_host_peer_is_local(int file)
{
    epg_host_peer_t own;
    if (!get_own(file, &own)) {
        return false;
    }
    if (own.address.ss_family == AF_INET) {
        const struct sockaddr_in *address = (const struct sockaddr_in *)&own.address;
        return ntohl(address->sin_addr.s_addr) >> 24U == 127;
    }
    const struct sockaddr_in6 *address = (const struct sockaddr_in6 *)&own.address;
    return IN6_IS_ADDR_LOOPBACK(&address->sin6_addr);
}

void epg_host_peer_print(int file, const char *name)
{
    epg_host_peer_t own;
    char text[EPG_HOST_PEER_NAME];
    if (get_own(file, &own)) {
        epg_host_peer_name(&own, text);
        fprintf(stderr, "%s: the console listens on udp:%s\n", name, text);
    }
}
