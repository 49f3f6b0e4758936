/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * UARTs whose interrupts move bytes between a buffer of one byte and the rings.
 */
#include "epg/one_core.h"
#include "epg/port_uart.h"

static const epg_port_uart_t *users[2];

static void receive(unsigned int number)
{
    UART(number)->interrupt = 2U;
    for (unsigned int i = 0; i < 16U && (UART(number)->state & 2U) != 0U; i++) {
        epg_ring_put(&users[number]->lines->received, (unsigned char)UART(number)->data);
    }
    epg_mcu_service_wake();
}

static void transmit(unsigned int number)
{
    UART(number)->interrupt = 1U;
    unsigned char byte;
    for (unsigned int i = 0;
         i < 16U && (UART(number)->state & 1U) == 0U && epg_ring_take(&users[number]->lines->sent, &byte); i++) {
        UART(number)->data = byte;
    }
}

static void on_receive0(void)
{
    receive(0);
}

static void on_receive1(void)
{
    receive(1);
}

static void on_transmit0(void)
{
    transmit(0);
}

static void on_transmit1(void)
{
    transmit(1);
}

static void empty(epg_ring_t *ring)
{
    atomic_store(&ring->put, 0U);
    atomic_store(&ring->taken, 0U);
    ring->put_at = 0U;
    ring->taken_at = 0U;
}

bool epg_port_uart_start(const epg_port_uart_t *port)
{
    static void (*const receivers[])(void) = {on_receive0, on_receive1};
    static void (*const transmitters[])(void) = {on_transmit0, on_transmit1};
    const unsigned int number = port->instance;
    epg_one_core_disable((IRQn_Type)(2U * number));
    epg_one_core_disable((IRQn_Type)(2U * number + 1U));
    users[number] = port;
    empty(&port->lines->received);
    empty(&port->lines->sent);
    UART(number)->divider = port->divider;
    UART(number)->ctrl = 0xFU;
    (void)UART(number)->data; /* QEMU asks its other end for bytes from this read on */
    epg_one_core_enable((IRQn_Type)(2U * number), receivers[number]);
    epg_one_core_enable((IRQn_Type)(2U * number + 1U), transmitters[number]);
    return true;
}

void epg_port_uart_send(const epg_port_uart_t *port)
{
    NVIC_SetPendingIRQ((IRQn_Type)(2U * port->instance + 1U));
}
