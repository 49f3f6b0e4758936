/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A UART as the transport of a middleware.
 *
 * Two rings (epg/ring.h) hold the bytes between the UART's interrupt handler and the communication side, so no function
 * waits for the wire.
 */
#ifndef EPG_UART_H
#define EPG_UART_H

#include "epg/port_uart.h"
#include "epg/transport.h"

typedef struct epg_uart {
    epg_port_uart_t port;
    epg_port_uart_lines_t lines;
} epg_uart_t;

/** Initialiser of an epg_transport_t over `uart`, a pointer to an epg_uart_t. */
#define EPG_UART_TRANSPORT(uart)                                                                                       \
    {                                                                                                                  \
        .start = epg_uart_start, .flush = epg_uart_flush, .lost = epg_uart_lost, .stream = {                           \
            .connected = epg_uart_connected,                                                                           \
            .read = epg_uart_read,                                                                                     \
            .write = epg_uart_write,                                                                                   \
            .writable = epg_uart_writable,                                                                             \
            .context = (uart),                                                                                         \
        }                                                                                                              \
    }

/* The functions of the transport; epg/transport.h and epg/stream.h describe them. */
bool epg_uart_start(void *context, const char *title);
void epg_uart_flush(void *context);
uint32_t epg_uart_lost(const void *context);
bool epg_uart_connected(void *context);
size_t epg_uart_read(void *context, void *data, size_t size);
size_t epg_uart_write(void *context, const void *data, size_t size);
size_t epg_uart_writable(void *context);

#endif
