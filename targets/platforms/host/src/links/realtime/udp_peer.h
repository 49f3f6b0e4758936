/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The socket of the console by UDP, and the addresses of its users.  No function waits.
 */
#ifndef EPG_HOST_UDP_PEER_H
#define EPG_HOST_UDP_PEER_H

#include <stdbool.h>
#include <stddef.h>

#include "sockets.h"

/** Size of an address as text, with its final 0. */
enum { EPG_HOST_PEER_NAME = 128 };

typedef struct epg_host_peer {
    struct sockaddr_storage address;
    socklen_t size;
} epg_host_peer_t;

/**
 * Makes a socket that listens on `address`, [ADDRESS:]PORT.  Without ADDRESS, only programs of this computer can reach
 * it.  Returns -1, after a message, if this fails.
 */
int epg_host_peer_listen(const char *address);

/** Returns true if only programs of this computer can reach the socket. */
bool epg_host_peer_is_local(int file);

/** Prints the address on which the socket of target `name` listens. */
void epg_host_peer_print(int file, const char *name);

bool epg_host_peer_equal(const epg_host_peer_t *one, const epg_host_peer_t *other);

/** Writes an address as text: 192.168.1.10:7000 or [::1]:7000. */
void epg_host_peer_name(const epg_host_peer_t *peer, char text[EPG_HOST_PEER_NAME]);

/**
 * Sends a datagram.  Returns false if the system does not have room for it now.  After another error the datagram is
 * lost, as in a network.
 */
bool epg_host_peer_send(int file, const epg_host_peer_t *peer, const void *data, size_t size);

/** Receives a datagram of any size, and the first `size` bytes of it.  Returns its own size; negative: there is none. */
long epg_host_peer_receive(int file, epg_host_peer_t *peer, void *data, size_t size);

#endif
