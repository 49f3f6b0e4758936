/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * UARTs.  The devicetree sets their baud rates and pins.
 */
#include <zephyr/drivers/uart.h>
#include <zephyr/kernel.h>

#include "epg/port_uart.h"
#include "parts.h"

/** Largest number of UARTs of a target. */
#define UARTS 4U

static epg_zephyr_lines_t lines[UARTS];

/** The row of a UART in the table of UARTs; `UARTS` if there is none. */
static size_t find(const epg_port_uart_t *port)
{
    for (size_t i = 0; i < epg_zephyr_hardware.uart_count && i < UARTS; i++) {
        if (epg_zephyr_hardware.uarts[i].instance == port->instance) {
            return i;
        }
    }
    return UARTS;
}

bool epg_port_uart_start(const epg_port_uart_t *port)
{
    const size_t row = find(port);
    if (row == UARTS || !epg_zephyr_ready(epg_zephyr_hardware.uarts[row].device)) {
        return false;
    }
    lines[row].device = epg_zephyr_hardware.uarts[row].device;
    lines[row].received = &port->lines->received;
    lines[row].sent = &port->lines->sent;
    lines[row].damaged = &port->lines->damaged;
    return epg_zephyr_lines_start(&lines[row]);
}

void epg_port_uart_send(const epg_port_uart_t *port)
{
    const size_t row = find(port);
    if (row < UARTS && lines[row].device != NULL) {
        epg_zephyr_lines_send(&lines[row]);
    }
}
