/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A UART as the transport of a middleware.
 */
#include "uart.h"

bool epg_uart_start(void *context, const char *title)
{
    (void)title; /* a UART cannot report a name to the other end */
    epg_uart_t *uart = context;
    return epg_port_uart_start(&uart->port);
}

void epg_uart_flush(void *context)
{
    epg_uart_t *uart = context;
    if (epg_ring_count(&uart->lines.sent) > 0U) {
        epg_port_uart_send(&uart->port);
    }
}

uint32_t epg_uart_lost(const void *context)
{
    const epg_uart_t *uart = context;
    return (uint32_t)atomic_load(&uart->lines.received.lost) + (uint32_t)atomic_load(&uart->lines.damaged);
}

bool epg_uart_connected(void *context)
{
    (void)context;
    return true; /* a UART cannot detect whether the other end is connected */
}

size_t epg_uart_read(void *context, void *data, size_t size)
{
    epg_uart_t *uart = context;
    return epg_port_uart_read(&uart->port, data, size);
}

size_t epg_uart_write(void *context, const void *data, size_t size)
{
    epg_uart_t *uart = context;
    return epg_ring_write(&uart->lines.sent, data, size);
}

size_t epg_uart_writable(void *context)
{
    const epg_uart_t *uart = context;
    return epg_ring_room(&uart->lines.sent);
}
