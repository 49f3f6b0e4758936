/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Moves bytes between a device of Zephyr's UART API and two rings, in the device's interrupt.
 *
 * The device is a UART, or a serial port on USB.  The "interrupt" of a port on USB is a work queue of Zephyr.
 */
#include <zephyr/drivers/uart.h>
#include <zephyr/kernel.h>

#include "parts.h"

/** Largest number of pieces that one run of the interrupt moves in each direction.  The rest raises it again. */
#define ROUNDS 8U
/** Largest size of a piece, in bytes. */
#define PIECE 32U

/**
 * Receives a piece.  With back pressure it takes at most as many bytes as the ring has room for, and stops receiving if
 * the ring is full.  False if there is nothing more to receive.
 */
static bool receive(const struct device *device, epg_zephyr_lines_t *lines)
{
    unsigned char piece[PIECE];
    size_t wanted = sizeof piece;
    if (lines->back_pressure) {
        wanted = MIN(wanted, epg_ring_room(lines->received));
        if (wanted == 0U) {
            uart_irq_rx_disable(device);
            atomic_store(&lines->full, true);
            return false;
        }
    }
    const int count = uart_fifo_read(device, piece, (int)wanted);
    for (int i = 0; i < count; i++) {
        epg_ring_put(lines->received, piece[i]);
    }
    return count > 0;
}

/**
 * Sends a piece: bytes that are adjacent in the ring's memory.  False if there is nothing more to send, or if the
 * device takes nothing more.  Pieces are small, because USB's driver copies one with interrupts off, which delays the
 * tick.
 */
static bool send(const struct device *device, epg_ring_t *ring)
{
    const uint32_t count = epg_ring_count(ring);
    if (count == 0U) {
        uart_irq_tx_disable(device);
        return false;
    }
    const uint32_t together = MIN(MIN(count, ring->size - ring->taken_at), PIECE);
    const int taken = uart_fifo_fill(device, ring->bytes + ring->taken_at, (int)together);
    if (taken <= 0) {
        return false;
    }
    const uint32_t at = ring->taken_at + (uint32_t)taken;
    ring->taken_at = at == ring->size ? 0U : at;
    atomic_store_explicit(&ring->taken, atomic_load_explicit(&ring->taken, memory_order_relaxed) + (unsigned int)taken,
                          memory_order_release);
    return true;
}

static void on_interrupt(const struct device *device, void *user)
{
    epg_zephyr_lines_t *lines = user;
    bool any = false;
    if (lines->damaged != NULL && uart_err_check(device) > 0) {
        /* A load and a store are enough, because no other context writes this counter. */
        atomic_store(lines->damaged, atomic_load(lines->damaged) + 1U);
    }
    for (uint32_t i = 0; i < ROUNDS && uart_irq_update(device) > 0 && uart_irq_is_pending(device) > 0; i++) {
        const bool received = uart_irq_rx_ready(device) > 0 && receive(device, lines);
        const bool sent = uart_irq_tx_ready(device) > 0 && send(device, lines->sent);
        any = any || received;
        if (!received && !sent) {
            break;
        }
    }
    if (any) {
        epg_zephyr_communication_wake();
    }
}

static void empty(epg_ring_t *ring)
{
    atomic_store(&ring->put, 0U);
    atomic_store(&ring->taken, 0U);
    ring->put_at = 0U;
    ring->taken_at = 0U;
}

bool epg_zephyr_lines_start(epg_zephyr_lines_t *lines)
{
    uart_irq_rx_disable(lines->device);
    uart_irq_tx_disable(lines->device);
    if (uart_irq_callback_user_data_set(lines->device, on_interrupt, lines) < 0) {
        return false;
    }
    empty(lines->received);
    empty(lines->sent);
    atomic_store(&lines->full, false);
    if (lines->damaged != NULL) {
        uart_irq_err_enable(lines->device);
    }
    uart_irq_rx_enable(lines->device);
    return true;
}

void epg_zephyr_lines_send(const epg_zephyr_lines_t *lines)
{
    if (epg_ring_count(lines->sent) > 0U) {
        uart_irq_tx_enable(lines->device);
    }
}

void epg_zephyr_lines_go_on(epg_zephyr_lines_t *lines)
{
    if (atomic_load(&lines->full) && epg_ring_room(lines->received) > 0U) {
        atomic_store(&lines->full, false);
        uart_irq_rx_enable(lines->device);
    }
}
