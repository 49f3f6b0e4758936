/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Serial lines with rings of one writer, the interrupt, and one reader, the main loop or a task.
 */
#include "line.h"

#include "board.h"

#define RING 1024U /* a power of two */

static struct {
    volatile uint32_t written; /* bytes since the start; written by the interrupt */
    volatile uint32_t read;    /* written by the reader */
    unsigned char bytes[RING];
} lines[UARTS];

void line_start(unsigned int number)
{
    board_uart_t *uart = UART(number);
    uart->divider = 16U;
    uart->ctrl = UART_TRANSMIT_ON | UART_RECEIVE_ON | UART_RECEIVE_INTERRUPT_ON;
    board_interrupt_on(2U * number, PRIORITY_UART);
    (void)uart->data; /* an old byte; QEMU asks its other end for bytes from this read on */
}

static void receive(unsigned int number)
{
    board_uart_t *uart = UART(number);
    uart->interrupt = UART_RECEIVE_INTERRUPT;
    while ((uart->state & UART_RECEIVE_FULL) != 0U) {
        const unsigned char byte = (unsigned char)uart->data;
        if (lines[number].written - lines[number].read < RING) {
            lines[number].bytes[lines[number].written % RING] = byte;
            lines[number].written++;
        }
    }
    line_received();
}

void uart0_handler(void);
void uart1_handler(void);
void uart2_handler(void);

void uart0_handler(void)
{
    receive(0);
}

void uart1_handler(void)
{
    receive(1);
}

void uart2_handler(void)
{
    receive(2);
}

static size_t line_waiting(unsigned int number)
{
    return lines[number].written - lines[number].read;
}

size_t line_read(unsigned int number, void *data, size_t size)
{
    unsigned char *bytes = data;
    size_t count = 0;
    while (count < size && line_waiting(number) > 0U) {
        bytes[count++] = lines[number].bytes[lines[number].read % RING];
        lines[number].read++;
    }
    return count;
}

size_t line_write(unsigned int number, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    size_t count = 0;
    while (count < size && (UART(number)->state & UART_TRANSMIT_FULL) == 0U) {
        UART(number)->data = bytes[count++];
    }
    return count;
}

void line_write_all(unsigned int number, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    for (size_t sent = 0; sent < size;) {
        sent += line_write(number, bytes + sent, size - sent);
    }
}
