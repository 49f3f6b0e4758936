/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * UARTs, served by DMA.
 *
 * Reception: a stream writes each byte into a circular buffer.  The interrupts of the line (idle for the time of one
 * byte) and of the stream (half of the buffer, all of it) copy the new bytes to the ring `received`.
 *
 * Transmission: the bytes of the ring `sent` are copied to a second buffer, which another stream sends.  The interrupt
 * at its end sends the next ones.
 *
 * The UART's own FIFOs stay off: the series F7 does not have them, and a byte with an error must not reach the buffer.
 * Without the FIFOs the UART drops such a byte (RM0433, 48.8.4, CR3: DDRE = 0).
 *
 * All interrupts of a UART and of its streams have the same priority, so none of them interrupts another one.
 */
#include "cache.h"
#include "epg/one_core.h"
#include "epg/port_uart.h"
#include "parts.h"
#include "uarts.h"

/** UARTs that can be used at the same time. */
#define CHANNELS 2U
/** Bytes of each circular buffer; whole lines of the cache.  One run of the interrupt copies at most this many. */
#define RECEIVE_SIZE 256U
/** Bytes that are sent at once; whole lines of the cache. */
#define SEND_SIZE 128U
/** Readings of position and flags, until no byte arrives between them. */
#define READINGS 3U

#define DAMAGED (USART_ISR_PE | USART_ISR_FE | USART_ISR_NE | USART_ISR_ORE)
#define CLEAR (USART_ICR_PECF | USART_ICR_FECF | USART_ICR_NECF | USART_ICR_ORECF | USART_ICR_IDLECF)

typedef struct channel {
    const epg_port_uart_t *port; /* NULL: the channel is free */
    const epg_stm32_uart_t *uart;
    epg_stm32_stream_t receive;
    epg_stm32_stream_t send;
    uint8_t *received;
    uint8_t *sent;
    uint32_t taken; /* place in `received` up to which bytes were copied */
} channel_t;

static uint8_t receive_buffers[CHANNELS][RECEIVE_SIZE] EPG_STM32_DMA;
static uint8_t send_buffers[CHANNELS][SEND_SIZE] EPG_STM32_DMA;
static channel_t channels[CHANNELS];

static void count_damage(epg_port_uart_lines_t *lines, uint32_t bytes)
{
    /* A load and a store are enough, because no other context writes this counter. */
    atomic_store(&lines->damaged, atomic_load(&lines->damaged) + bytes);
}

/* Reception ------------------------------------------------------------------------------------------------------ */

/**
 * The place that the stream writes next, and the flags that it has set since the last call.  Both are read until they
 * belong together.
 */
static uint32_t position(const channel_t *channel, uint32_t *flags)
{
    uint32_t place = 0;
    *flags = epg_stm32_dma_flags(&channel->receive);
    for (uint32_t i = 0; i < READINGS; i++) {
        place = (RECEIVE_SIZE - channel->receive.registers->NDTR) % RECEIVE_SIZE;
        const uint32_t later = epg_stm32_dma_flags(&channel->receive);
        *flags |= later;
        if (later == 0U) {
            break;
        }
    }
    return place;
}

/**
 * True if the stream has overwritten bytes that were not copied: it has passed the middle or the end of the buffer,
 * which are not on the way from `taken` to `place`.
 */
static bool overwritten(uint32_t taken, uint32_t place, uint32_t flags)
{
    const uint32_t middle = RECEIVE_SIZE / 2U;
    const bool wrapped = place < taken;
    const bool passes_middle = wrapped ? taken < middle || place >= middle : taken < middle && place >= middle;
    return ((flags & EPG_STM32_DMA_HALF) != 0U && !passes_middle) ||
           ((flags & EPG_STM32_DMA_COMPLETE) != 0U && !wrapped);
}

/** Copies the new bytes to the ring.  Returns true if there are any. */
static bool take_received(channel_t *channel)
{
    epg_port_uart_lines_t *lines = channel->port->lines;
    uint32_t flags;
    const uint32_t place = position(channel, &flags);
    if (overwritten(channel->taken, place, flags)) {
        count_damage(lines, RECEIVE_SIZE);
        channel->taken = place;
        return false;
    }
    if (channel->taken == place) {
        return false;
    }
    epg_stm32_cache_drop(channel->received, RECEIVE_SIZE);
    for (uint32_t i = 0; i < RECEIVE_SIZE && channel->taken != place; i++) {
        epg_ring_put(&lines->received, channel->received[channel->taken]);
        channel->taken = (channel->taken + 1U) % RECEIVE_SIZE;
    }
    return true;
}

static void start_receiving(channel_t *channel)
{
    DMA_Stream_TypeDef *stream = channel->receive.registers;
    channel->taken = 0;
    stream->PAR = (uint32_t)(uintptr_t)&channel->uart->registers->RDR;
    stream->M0AR = (uint32_t)(uintptr_t)channel->received;
    stream->NDTR = RECEIVE_SIZE;
    stream->FCR = 0; /* direct mode: each byte is written to memory at once (RM0433, 15.3.14) */
    /* from peripheral to memory, bytes */
    stream->CR = channel->receive.bits | DMA_SxCR_MINC | DMA_SxCR_CIRC | DMA_SxCR_HTIE | DMA_SxCR_TCIE;
    epg_stm32_cache_clean(channel->received, RECEIVE_SIZE); /* no line of the buffer may be written later */
    stream->CR |= DMA_SxCR_EN;
}

/* Transmission --------------------------------------------------------------------------------------------------- */

/** Sends the next bytes of the ring, unless the stream still sends those before. */
static void send_next(channel_t *channel)
{
    DMA_Stream_TypeDef *stream = channel->send.registers;
    if ((stream->CR & DMA_SxCR_EN) != 0U) {
        return;
    }
    (void)epg_stm32_dma_flags(&channel->send); /* a stream cannot be enabled before (RM0433, 15.3.19) */
    const size_t count = epg_ring_read(&channel->port->lines->sent, channel->sent, SEND_SIZE);
    if (count == 0U) {
        return;
    }
    epg_stm32_cache_clean(channel->sent, SEND_SIZE);
    stream->NDTR = (uint32_t)count;
    stream->CR |= DMA_SxCR_EN;
}

static void prepare_sending(const channel_t *channel)
{
    DMA_Stream_TypeDef *stream = channel->send.registers;
    stream->PAR = (uint32_t)(uintptr_t)&channel->uart->registers->TDR;
    stream->M0AR = (uint32_t)(uintptr_t)channel->sent;
    stream->FCR = 0;
    /* from memory to peripheral, bytes */
    stream->CR = channel->send.bits | DMA_SxCR_DIR_0 | DMA_SxCR_MINC | DMA_SxCR_TCIE;
}

/* Interrupts ------------------------------------------------------------------------------------------------------ */

static void serve(channel_t *channel)
{
    USART_TypeDef *registers = channel->uart->registers;
    if ((registers->ISR & DAMAGED) != 0U) {
        count_damage(channel->port->lines, 1U);
    }
    registers->ICR = CLEAR;
    const bool any = take_received(channel);
    send_next(channel);
    if (any) {
        epg_mcu_service_wake();
    }
}

static void on_first(void)
{
    serve(&channels[0]);
}

static void on_second(void)
{
    serve(&channels[1]);
}

static const epg_one_core_handler_t handlers[CHANNELS] = {on_first, on_second};

/* Start ----------------------------------------------------------------------------------------------------------- */

static void empty(epg_ring_t *ring)
{
    atomic_store(&ring->put, 0U);
    atomic_store(&ring->taken, 0U);
    ring->put_at = 0U;
    ring->taken_at = 0U;
}

/** The channel of `port`, else a free one; NULL if there is none. */
static channel_t *channel_of(const epg_port_uart_t *port)
{
    channel_t *found = NULL;
    for (size_t i = CHANNELS; i > 0U; i--) {
        channel_t *channel = &channels[i - 1U];
        if (channel->port == port) {
            return channel;
        }
        if (channel->port == NULL) {
            found = channel;
        }
    }
    return found;
}

/** True if other code uses the UART. */
static bool taken_by_others(const epg_stm32_uart_t *uart)
{
    return ((*uart->clock & uart->bit) != 0U && (uart->registers->CR1 & USART_CR1_UE) != 0U) ||
           NVIC_GetEnableIRQ(uart->interrupt) != 0U;
}

/** Takes the UART and two streams for a free channel.  Returns false if other code uses them. */
static bool take(channel_t *channel, const epg_port_uart_t *port)
{
    const size_t number = (size_t)(channel - channels);
    const epg_stm32_uart_t *uart = epg_stm32_uart_find(epg_stm32_hardware.uarts[port->instance]);
    if (uart == NULL || taken_by_others(uart)) {
        return false;
    }
    epg_stm32_dma_clock();
    if (!epg_stm32_uart_take_streams(uart, &channel->receive, &channel->send)) {
        return false;
    }
    channel->received = receive_buffers[number];
    channel->sent = send_buffers[number];
    channel->uart = uart;
    channel->port = port;
    return true;
}

/** Stops a channel that was started before.  False if a stream does not stop. */
static bool stop(const channel_t *channel)
{
    epg_one_core_disable(channel->uart->interrupt);
    epg_one_core_disable(channel->receive.interrupt);
    epg_one_core_disable(channel->send.interrupt);
    return epg_stm32_dma_stop(&channel->receive) && epg_stm32_dma_stop(&channel->send);
}

static void start_uart(const epg_port_uart_t *port, const epg_stm32_uart_t *uart)
{
    USART_TypeDef *registers = uart->registers;
    const uint32_t before = epg_stm32_enter();
    *uart->clock |= uart->bit;
    *uart->reset |= uart->bit; /* all registers have the values of a reset: 8N1, 16 samples per bit, no FIFOs */
    *uart->reset &= ~uart->bit;
    epg_stm32_leave(before);
    registers->BRR = port->divider;
    registers->CR3 = USART_CR3_DMAR | USART_CR3_DMAT | USART_CR3_EIE;
    registers->CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_IDLEIE;
}

bool epg_port_uart_start(const epg_port_uart_t *port)
{
    if (!epg_stm32_dma_reaches(receive_buffers, sizeof receive_buffers) ||
        !epg_stm32_dma_reaches(send_buffers, sizeof send_buffers)) {
        epg_mcu_refuse(EPG_MCU_ERROR_PLACEMENT);
        return false;
    }
    channel_t *channel = channel_of(port);
    if (channel == NULL || !(channel->port == port ? stop(channel) : take(channel, port))) {
        return false;
    }
    empty(&port->lines->received);
    empty(&port->lines->sent);
    start_uart(port, channel->uart);
    prepare_sending(channel);
    start_receiving(channel);
    epg_stm32_connect(port->pin_tx, EPG_PULL_NONE);
    epg_stm32_connect(port->pin_rx, EPG_PULL_UP); /* a low level on an open pin would look like a break */
    const epg_one_core_handler_t handler = handlers[channel - channels];
    epg_one_core_enable(channel->receive.interrupt, handler);
    epg_one_core_enable(channel->send.interrupt, handler);
    epg_one_core_enable(channel->uart->interrupt, handler);
    return true;
}

void epg_port_uart_send(const epg_port_uart_t *port)
{
    const channel_t *channel = channel_of(port);
    if (channel != NULL && channel->port == port) {
        NVIC_SetPendingIRQ(channel->uart->interrupt);
    }
}
