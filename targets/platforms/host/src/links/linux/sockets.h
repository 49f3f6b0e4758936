/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sockets of Linux.  No function waits.
 */
#ifndef EPG_HOST_SOCKETS_H
#define EPG_HOST_SOCKETS_H

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/** Must be called before all other functions. */
static inline void epg_host_sockets_start(void)
{
}

/** Makes a socket for this kind of address; -1 if this fails. */
static inline int epg_host_socket_open(const struct addrinfo *address)
{
    return socket(address->ai_family, address->ai_socktype, address->ai_protocol);
}

static inline bool epg_host_socket_bind(int file, const struct addrinfo *address)
{
    return bind(file, address->ai_addr, address->ai_addrlen) == 0;
}

static inline bool epg_host_socket_connect(int file, const struct addrinfo *address)
{
    return connect(file, address->ai_addr, address->ai_addrlen) == 0;
}

/** Sends a datagram; `size` is 0 if the socket is connected. */
static inline long epg_host_socket_send(int file, const void *data, size_t length, const void *address, socklen_t size)
{
    return sendto(file, data, length, MSG_DONTWAIT | MSG_NOSIGNAL, size == 0 ? NULL : address, size);
}

/** Receives a datagram; returns its own length, also if it is longer than `length`. */
static inline long epg_host_socket_receive(int file, void *data, size_t length, void *address, socklen_t *size)
{
    return recvfrom(file, data, length, MSG_DONTWAIT | MSG_TRUNC, address, size);
}

static inline void epg_host_socket_close(int file)
{
    close(file);
}

static inline bool epg_host_socket_name(int file, void *address, socklen_t *size)
{
    return getsockname(file, address, size) == 0;
}

/** The error of the last call. */
static inline int epg_host_socket_error(void)
{
    return errno;
}

static inline const char *epg_host_socket_text(int error)
{
    return strerror(error);
}

/** True if the system has no room for a datagram now. */
static inline bool epg_host_socket_is_full(int error)
{
    return error == EAGAIN || error == EWOULDBLOCK || error == ENOBUFS;
}

/** True if a call failed because of an earlier packet.  Linux reports such an error once; the call must be repeated. */
static inline bool epg_host_socket_was_refused(int error)
{
    return error == ECONNREFUSED || error == EINTR || error == EHOSTUNREACH || error == ENETUNREACH;
}

static inline bool epg_host_socket_is_taken(int error)
{
    return error == EADDRINUSE;
}

static inline bool epg_host_socket_is_foreign(int error)
{
    return error == EADDRNOTAVAIL;
}

#endif
