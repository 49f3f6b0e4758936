/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * UARTs (RP2040 data sheet 4.2, PL011).
 *
 * The hardware has a FIFO of 32 bytes for each direction.  Its interrupt, on core 0, moves bytes between the FIFOs and
 * two ring buffers in memory, from which the communication side reads and to which it writes.
 */
#include "epg/port_uart.h"
#include "parts.h"
#include "uart_sdk.h"

/** Entries of each FIFO.  One run of the interrupt moves at most this many bytes in each direction. */
#define FIFO 32U

#define DAMAGED (UART_UARTDR_BE_BITS | UART_UARTDR_PE_BITS | UART_UARTDR_FE_BITS)
#define RECEIVE_INTERRUPTS (UART_UARTIMSC_RXIM_BITS | UART_UARTIMSC_RTIM_BITS)
#define ALL_INTERRUPTS 0x7FFU

static const epg_port_uart_t *users[NUM_UARTS];

static void count_damage(epg_port_uart_lines_t *lines)
{
    /* A load and a store are enough, because no other context writes this counter. */
    atomic_store(&lines->damaged, atomic_load(&lines->damaged) + 1U);
}

static bool receive(uart_hw_t *hw, epg_port_uart_lines_t *lines)
{
    bool any = false;
    for (uint32_t i = 0; i < FIFO && (hw->fr & UART_UARTFR_RXFE_BITS) == 0U; i++) {
        const uint32_t data = hw->dr;
        if ((data & DAMAGED) != 0U) {
            count_damage(lines);
        } else {
            epg_ring_put(&lines->received, (unsigned char)data);
            any = true;
        }
    }
    return any;
}

static void send(uart_hw_t *hw, epg_port_uart_lines_t *lines)
{
    unsigned char byte;
    for (uint32_t i = 0; i < FIFO && (hw->fr & UART_UARTFR_TXFF_BITS) == 0U && epg_ring_take(&lines->sent, &byte);
         i++) {
        hw->dr = byte;
    }
    /* The interrupt is raised when the FIFO becomes half empty.  Enable it only if the ring has bytes left. */
    hw_write_masked(&hw->imsc, epg_ring_count(&lines->sent) > 0U ? UART_UARTIMSC_TXIM_BITS : 0U,
                    UART_UARTIMSC_TXIM_BITS);
}

static void serve(uint number)
{
    epg_port_uart_lines_t *lines = users[number]->lines;
    uart_hw_t *hw = uart_get_hw(UART_INSTANCE(number));
    if ((hw->ris & UART_UARTRIS_OERIS_BITS) != 0U) {
        count_damage(lines); /* the FIFO was full, and at least one byte was lost */
    }
    hw->icr = ALL_INTERRUPTS; /* before the FIFOs are read: a later byte raises the interrupt again */
    const bool any = receive(hw, lines);
    send(hw, lines);
    if (any) {
        epg_mcu_service_wake();
    }
}

static void on_uart0(void)
{
    serve(0);
}

static void on_uart1(void)
{
    serve(1);
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
    uart_inst_t *uart = UART_INSTANCE(port->instance);
    const uint irq = UART_IRQ_NUM(uart);
    const bool mine = users[port->instance] == port;
    if (!mine && (uart_is_enabled(uart) || irq_get_exclusive_handler(irq) != NULL || irq_has_shared_handler(irq))) {
        return false;
    }
    irq_set_enabled(irq, false);
    empty(&port->lines->received);
    empty(&port->lines->sent);
    uart_init(uart, 115200); /* ends the reset, sets 8N1 and enables the FIFOs; the generator's divider follows */
    uart_hw_t *hw = uart_get_hw(uart);
    const uint32_t control = hw->cr;
    hw->cr = 0;
    hw->ibrd = port->divider >> 6U;
    hw->fbrd = port->divider & 63U;
    hw->lcr_h = hw->lcr_h; /* a write to LCR_H makes the hardware use the new divider (4.2.7.1) */
    hw->cr = control;
    hw->imsc = RECEIVE_INTERRUPTS;
    if (!mine) {
        irq_set_exclusive_handler(irq, port->instance == 0U ? on_uart0 : on_uart1);
        users[port->instance] = port;
    }
    /* Pull RX up: a low level on an open pin would look like a break. */
    gpio_pull_up(port->pin_rx);
    gpio_set_function(port->pin_rx, UART_FUNCSEL_NUM(uart, port->pin_rx));
    gpio_set_function(port->pin_tx, UART_FUNCSEL_NUM(uart, port->pin_tx));
    irq_set_enabled(irq, true);
    return true;
}

void epg_port_uart_send(const epg_port_uart_t *port)
{
    irq_set_pending(UART_IRQ_NUM(UART_INSTANCE(port->instance)));
}
