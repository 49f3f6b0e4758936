/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The part of the port layer that is about UARTs.
 *
 * A platform that offers the class `uart` implements it.  All functions belong to the communication side and return at
 * once; an interrupt moves the bytes between the UART and two rings.
 */
#ifndef EPG_PORT_UART_H
#define EPG_PORT_UART_H

#include "epg/ring.h"

/** What goes over a UART. */
typedef struct epg_port_uart_lines {
    epg_ring_t received;
    epg_ring_t sent;
    atomic_uint damaged; /**< bytes received with a framing, parity or break error, or lost within the UART */
} epg_port_uart_lines_t;

/** A UART: 8 data bits, no parity, 1 stop bit.  `instance` names the peripheral. */
typedef struct epg_port_uart {
    uint8_t pin_tx;
    uint8_t pin_rx;
    uint8_t instance;
    uint32_t divider; /**< the clock that the chip's description states for UARTs, divided by this, is the baud rate */
    epg_port_uart_lines_t *lines;
} epg_port_uart_t;

/**
 * Starts a UART with empty rings: what comes is put into `lines->received`, without waking anybody up but the platform.
 * False when somebody else uses it, or when its clock is not the one that `divider` was computed for.  Before the
 * control loop starts; a second call starts it anew.
 */
bool epg_port_uart_start(const epg_port_uart_t *uart);

/** There is something in `lines->sent`: it is taken out and sent. */
void epg_port_uart_send(const epg_port_uart_t *uart);

#endif
