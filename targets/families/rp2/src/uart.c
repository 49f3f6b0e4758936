/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * UARTs (RP2040 data sheet 4.2, PL011; 2.5, DMA).
 *
 * Reception: the DMA writes each byte with the flags of its errors into the buffer, whether interrupts are enabled or
 * not: while core 0 writes to flash, none of its interrupts runs for 45 to 400 ms.  The communication side reads the
 * buffer in each of its turns.  A transfer of the DMA has an end.  Two channels therefore take turns: at the end of its
 * transfer, each starts the other one, which goes on at the same place of the buffer.
 *
 * Transmission: the hardware has a FIFO of 32 bytes.  Its interrupt, on core 0, moves bytes to it from the ring to which
 * the communication side writes.
 */
#include "epg/port_uart.h"
#include "parts.h"
#include "uart_sdk.h"

/** Entries of the FIFO.  One run of the interrupt moves at most this many bytes. */
#define FIFO 32U

/**
 * Bytes of a transfer: a multiple of each size of a buffer, and below 2^28, the limit of RP2350.  At 3 MBaud it takes
 * seven minutes, much longer than the time from one turn of the communication side to the next.
 */
#define TRANSFER (1UL << 27)

/** If bytes were lost, so many bytes before them are given up, too: more will arrive while the others are read. */
#define MARGIN 32U

#define DAMAGED (UART_UARTDR_BE_BITS | UART_UARTDR_PE_BITS | UART_UARTDR_FE_BITS)

typedef struct reception {
    const epg_port_uart_t *port; /* NULL: the UART is not in use */
    uint channels[2];
    uint32_t taken; /* bytes that were read, modulo TRANSFER */
} reception_t;

static reception_t receptions[NUM_UARTS];

/* Reception ------------------------------------------------------------------------------------------------------ */

static void add(atomic_uint *counter, uint32_t count)
{
    /* A load and a store are enough, because no other context writes the counters. */
    atomic_store(counter, atomic_load(counter) + count);
}

/**
 * The bytes that the DMA has written, modulo TRANSFER.  A channel counts down to 0, and begins again when the other one
 * starts it.  If the turn changes between the two readings, the result is at most the bytes between them too low.
 */
static uint32_t written(const reception_t *reception)
{
    const uint32_t left =
        dma_hw->ch[reception->channels[0]].transfer_count + dma_hw->ch[reception->channels[1]].transfer_count;
    return (0U - left) % TRANSFER;
}

static uint32_t waiting(const reception_t *reception, uint32_t since)
{
    return (written(reception) - since) % TRANSFER;
}

size_t epg_port_uart_read(const epg_port_uart_t *port, void *data, size_t size)
{
    reception_t *reception = &receptions[port->instance];
    epg_port_uart_lines_t *lines = port->lines;
    uart_hw_t *hw = uart_get_hw(UART_INSTANCE(port->instance));
    const volatile uint16_t *entries = (const volatile uint16_t *)(const void *)lines->received.bytes;
    const uint32_t room = lines->received.size; /* a power of two: family_uart.h */
    unsigned char *bytes = data;
    if ((hw->ris & UART_UARTRIS_OERIS_BITS) != 0U) {
        hw->icr = UART_UARTICR_OEIC_BITS;
        add(&lines->damaged, 1U); /* the FIFO was full, and at least one byte was lost */
    }
    uint32_t count = waiting(reception, reception->taken);
    if (count > room) {
        const uint32_t lost = count - (room - MARGIN);
        add(&lines->received.lost, lost);
        reception->taken += lost;
        count -= lost;
    }
    const uint32_t begin = reception->taken;
    const uint32_t end = begin + (count < size ? count : (uint32_t)size);
    size_t good = 0;
    uint32_t damaged = 0;
    for (uint32_t at = begin; at != end; at++) {
        const uint16_t entry = entries[at & (room - 1U)];
        if ((entry & DAMAGED) != 0U) {
            damaged++;
        } else {
            bytes[good++] = (unsigned char)entry;
        }
    }
    reception->taken = end;
    if (waiting(reception, begin) > room) { /* the DMA has overwritten them meanwhile */
        add(&lines->received.lost, end - begin);
        return 0;
    }
    add(&lines->damaged, damaged);
    return good;
}

/** Claims two channels of the DMA and starts them.  Returns false if other code has them all. */
static bool start_receiving(reception_t *reception, const epg_port_uart_t *port)
{
    const int first = dma_claim_unused_channel(false);
    const int second = dma_claim_unused_channel(false);
    if (second < 0) {
        if (first >= 0) {
            dma_channel_unclaim((uint)first);
        }
        return false;
    }
    uart_inst_t *uart = UART_INSTANCE(port->instance);
    const uint ring_bits = 31U - (uint)__builtin_clz(port->lines->received.size * (uint32_t)sizeof(uint16_t));
    reception->channels[0] = (uint)first;
    reception->channels[1] = (uint)second;
    for (size_t i = 0; i < 2U; i++) {
        dma_channel_config config = dma_channel_get_default_config(reception->channels[i]);
        channel_config_set_transfer_data_size(&config, DMA_SIZE_16);
        channel_config_set_read_increment(&config, false);
        channel_config_set_write_increment(&config, true);
        channel_config_set_ring(&config, true, ring_bits);
        channel_config_set_dreq(&config, uart_get_dreq(uart, false));
        channel_config_set_chain_to(&config, reception->channels[1U - i]);
        channel_config_set_irq_quiet(&config, true);
        dma_channel_configure(reception->channels[i], &config, port->lines->received.bytes, &uart_get_hw(uart)->dr,
                              TRANSFER, false);
    }
    dma_channel_start(reception->channels[0]);
    return true;
}

/* Transmission --------------------------------------------------------------------------------------------------- */

static void send(uint number)
{
    epg_port_uart_lines_t *lines = receptions[number].port->lines;
    uart_hw_t *hw = uart_get_hw(UART_INSTANCE(number));
    unsigned char byte;
    hw->icr = UART_UARTICR_TXIC_BITS; /* before the FIFO is filled: when it becomes empty, the interrupt comes again */
    for (uint32_t i = 0; i < FIFO && (hw->fr & UART_UARTFR_TXFF_BITS) == 0U && epg_ring_take(&lines->sent, &byte);
         i++) {
        hw->dr = byte;
    }
    /* The interrupt is raised when the FIFO becomes half empty.  Enable it only if the ring has bytes left. */
    hw_write_masked(&hw->imsc, epg_ring_count(&lines->sent) > 0U ? UART_UARTIMSC_TXIM_BITS : 0U,
                    UART_UARTIMSC_TXIM_BITS);
}

static void on_uart0(void)
{
    send(0);
}

static void on_uart1(void)
{
    send(1);
}

/* Start ---------------------------------------------------------------------------------------------------------- */

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
    reception_t *reception = &receptions[port->instance];
    const bool mine = reception->port == port;
    if (!mine && (uart_is_enabled(uart) || irq_get_exclusive_handler(irq) != NULL || irq_has_shared_handler(irq))) {
        return false;
    }
    irq_set_enabled(irq, false);
    empty(&port->lines->sent);
    uart_init(uart, 115200); /* ends the reset, sets 8N1 and enables the FIFOs; the generator's divider follows */
    uart_hw_t *hw = uart_get_hw(uart);
    const uint32_t control = hw->cr;
    hw->cr = 0;
    hw->ibrd = port->divider >> 6U;
    hw->fbrd = port->divider & 63U;
    hw->lcr_h = hw->lcr_h; /* a write to LCR_H makes the hardware use the new divider (4.2.7.1) */
    hw->dmacr = 0;
    if (!mine && !start_receiving(reception, port)) {
        uart_deinit(uart);
        return false;
    }
    for (size_t i = 0; mine && i < 2U; i++) { /* requests of the UART before its reset do not count */
        dma_debug_hw->ch[reception->channels[i]].dbg_ctdreq = 0;
    }
    reception->taken = written(reception);
    hw->dmacr = UART_UARTDMACR_RXDMAE_BITS;
    hw->cr = control;
    if (!mine) {
        reception->port = port;
        irq_set_exclusive_handler(irq, port->instance == 0U ? on_uart0 : on_uart1);
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
