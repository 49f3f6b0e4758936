/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Sockets of Windows.  No function waits.
 */
#ifndef EPG_HOST_SOCKETS_H
#define EPG_HOST_SOCKETS_H

#include <stdbool.h>
#include <stdio.h>

#define WIN32_LEAN_AND_MEAN /* else windows.h makes 'interface' a macro */
#include <winsock2.h>

#include <mswsock.h>
#include <ws2tcpip.h>

/** Must be called before all other functions. */
static inline void epg_host_sockets_start(void)
{
    static bool started;
    WSADATA data;
    started = started || WSAStartup(MAKEWORD(2, 2), &data) == 0;
}

/** Makes a socket for this kind of address; -1 if this fails.  Handles have 32 bits, also in programs with 64. */
static inline int epg_host_socket_open(const struct addrinfo *address)
{
    const SOCKET made = socket(address->ai_family, address->ai_socktype, address->ai_protocol);
    u_long on = 1;
    BOOL reports = FALSE; /* else a datagram to a port without a program makes the next call for another address fail */
    DWORD count;
    if (made == INVALID_SOCKET) {
        return -1;
    }
    (void)ioctlsocket(made, (long)FIONBIO, &on);
    (void)WSAIoctl(made, SIO_UDP_CONNRESET, &reports, sizeof reports, NULL, 0, &count, NULL, NULL);
    return (int)made;
}

/** Without the exclusive use, another program could take over the port. */
static inline bool epg_host_socket_bind(int file, const struct addrinfo *address)
{
    const BOOL exclusive = TRUE;
    (void)setsockopt((SOCKET)file, SOL_SOCKET, SO_EXCLUSIVEADDRUSE, (const char *)&exclusive, sizeof exclusive);
    return bind((SOCKET)file, address->ai_addr, (int)address->ai_addrlen) == 0;
}

static inline bool epg_host_socket_connect(int file, const struct addrinfo *address)
{
    return connect((SOCKET)file, address->ai_addr, (int)address->ai_addrlen) == 0;
}

/** Sends a datagram; `size` is 0 if the socket is connected. */
static inline long epg_host_socket_send(int file, const void *data, size_t length, const void *address, socklen_t size)
{
    return sendto((SOCKET)file, data, (int)length, 0, size == 0 ? NULL : address, size);
}

/** Receives a datagram; returns its own length, or one more than `length` if it is longer. */
static inline long epg_host_socket_receive(int file, void *data, size_t length, void *address, socklen_t *size)
{
    const int count = recvfrom((SOCKET)file, data, (int)length, 0, address, size);
    return count < 0 && WSAGetLastError() == WSAEMSGSIZE ? (long)length + 1 : count;
}

static inline void epg_host_socket_close(int file)
{
    closesocket((SOCKET)file);
}

static inline bool epg_host_socket_name(int file, void *address, socklen_t *size)
{
    return getsockname((SOCKET)file, address, size) == 0;
}

/** The error of the last call. */
static inline int epg_host_socket_error(void)
{
    return WSAGetLastError();
}

static inline const char *epg_host_socket_text(int error)
{
    static char text[40];
    (void)snprintf(text, sizeof text, "error %d of Windows", error);
    return text;
}

/** True if the system has no room for a datagram now. */
static inline bool epg_host_socket_is_full(int error)
{
    return error == WSAEWOULDBLOCK || error == WSAENOBUFS;
}

/** True if a call failed because of an earlier packet; the call must be repeated. */
static inline bool epg_host_socket_was_refused(int error)
{
    return error == WSAECONNRESET || error == WSAENETRESET || error == WSAEHOSTUNREACH || error == WSAENETUNREACH;
}

static inline bool epg_host_socket_is_taken(int error)
{
    return error == WSAEADDRINUSE || error == WSAEACCES;
}

static inline bool epg_host_socket_is_foreign(int error)
{
    return error == WSAEADDRNOTAVAIL;
}

#endif
