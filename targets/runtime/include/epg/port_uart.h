/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The part of the port layer for UARTs: serial ports with one wire per direction.
 *
 * A platform that offers the resource class `uart` implements these functions.  An interrupt handler moves the bytes
 * between the UART and two rings (epg/ring.h), so no function waits for a byte.  All functions are called from the
 * communication side and return at once.
 *
 * A family of chips whose hardware writes received bytes into memory has a header epg/family_uart.h.  It defines
 * EPG_PORT_UART_BUFFER(), and the family implements epg_port_uart_read().  The members `bytes` and `size` of the ring
 * `received` are then the buffer and the number of received bytes for which it has room.
 */
#ifndef EPG_PORT_UART_H
#define EPG_PORT_UART_H

#include "epg/ring.h"

#if defined __has_include
#if __has_include("epg/family_uart.h")
#include "epg/family_uart.h"
#endif
#endif

/** The bytes of a UART on their way between the interrupt handler and the communication side. */
typedef struct epg_port_uart_lines {
    epg_ring_t received;
    epg_ring_t sent;
    atomic_uint damaged; /**< bytes received with a framing, parity or break error, or lost inside the UART */
} epg_port_uart_lines_t;

/** A UART: 8 data bits, no parity, 1 stop bit. */
typedef struct epg_port_uart {
    uint8_t pin_tx;
    uint8_t pin_rx;
    uint8_t instance; /**< number of the UART peripheral */
    uint32_t divider; /**< baud rate = UART clock in the description of the SoC / divider */
    epg_port_uart_lines_t *lines;
} epg_port_uart_t;

/**
 * Starts the UART with empty rings.  From then on the interrupt handler puts received bytes into `lines->received` and
 * wakes the platform's communication side.  Returns false if other code already uses the UART.  The port layer has
 * verified the clock for which `divider` was computed.  Called before the control loop starts; a second call starts the
 * UART again.
 */
bool epg_port_uart_start(const epg_port_uart_t *uart);

#ifdef EPG_PORT_UART_BUFFER

/** Takes up to `size` received bytes and returns their number. */
size_t epg_port_uart_read(const epg_port_uart_t *uart, void *data, size_t size);

#else

/** Defines the buffer `name` for at least `size` received bytes. */
#define EPG_PORT_UART_BUFFER(name, size) static unsigned char name[size]

/** Takes up to `size` received bytes and returns their number. */
static inline size_t epg_port_uart_read(const epg_port_uart_t *uart, void *data, size_t size)
{
    return epg_ring_read(&uart->lines->received, data, size);
}

#endif

/** Starts the transmission of the bytes in `lines->sent`.  Called after bytes were put into that ring. */
void epg_port_uart_send(const epg_port_uart_t *uart);

#endif
