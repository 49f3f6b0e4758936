/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sockets of POSIX.  No function waits.
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
    return sendto(file, data, length, MSG_DONTWAIT, size == 0 ? NULL : address, size);
}

/** Receives a datagram; returns its own length, or one more than `length` if it is longer. */
static inline long epg_host_socket_receive(int file, void *data, size_t length, void *address, socklen_t *size)
{
    struct iovec part = {.iov_base = data, .iov_len = length};
    struct msghdr message = {
        .msg_name = address, .msg_namelen = size != NULL ? *size : 0, .msg_iov = &part, .msg_iovlen = 1};
    const long count = recvmsg(file, &message, MSG_DONTWAIT);
    if (size != NULL) {
        *size = message.msg_namelen;
    }
    return count >= 0 && (message.msg_flags & MSG_TRUNC) != 0 ? (long)length + 1 : count;
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

/** True if a call failed because of an earlier packet.  Such an error is reported once; the call must be repeated. */
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
