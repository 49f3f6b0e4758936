/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32F7: the UARTs, the streams that serve them, and the memories that a DMA reaches.
 *
 * Each request of a UART is connected to one or two streams; the channel of the stream selects the request (RM0410,
 * DMA, tables "DMA1 request mapping" and "DMA2 request mapping").  If other code uses the streams of a UART, EPG cannot
 * use that UART.
 */
#include "../uarts.h"

#include "../parts.h"

/** A stream of the DMA and its channel, as a request of `epg_stm32_uart_t`; streams 8 to 15 are those of DMA2. */
#define REQUEST(stream, channel) ((stream) << 4U | (channel))
#define STREAM(request) ((request) >> 4U)
#define CHANNEL(request) ((request)&15U)

#define ON_APB1(kind, n, receive, transmit)                                                                            \
    {                                                                                                                  \
        .number = (n), .receive_request = (receive), .transmit_request = (transmit), .interrupt = kind##n##_IRQn,      \
        .registers = kind##n, .clock = &RCC->APB1ENR, .reset = &RCC->APB1RSTR, .bit = RCC_APB1ENR_##kind##n##EN,       \
    }
#define ON_APB2(kind, n, receive, transmit)                                                                            \
    {                                                                                                                  \
        .number = (n), .receive_request = (receive), .transmit_request = (transmit), .interrupt = kind##n##_IRQn,      \
        .registers = kind##n, .clock = &RCC->APB2ENR, .reset = &RCC->APB2RSTR, .bit = RCC_APB2ENR_##kind##n##EN,       \
    }

static const epg_stm32_uart_t uarts[] = {
    ON_APB2(USART, 1, REQUEST(10, 4), REQUEST(15, 4)), ON_APB1(USART, 2, REQUEST(5, 4), REQUEST(6, 4)),
    ON_APB1(USART, 3, REQUEST(1, 4), REQUEST(3, 4)),   ON_APB1(UART, 4, REQUEST(2, 4), REQUEST(4, 4)),
    ON_APB1(UART, 5, REQUEST(0, 4), REQUEST(7, 4)),    ON_APB2(USART, 6, REQUEST(9, 5), REQUEST(14, 5)),
    ON_APB1(UART, 7, REQUEST(3, 5), REQUEST(1, 5)),    ON_APB1(UART, 8, REQUEST(6, 5), REQUEST(0, 5)),
};

/** Requests that a second stream can serve, with that stream. */
static const struct {
    uint8_t request;
    uint8_t other;
} second[] = {
    {REQUEST(10, 4), REQUEST(13, 4)}, /* USART1_RX */
    {REQUEST(3, 4), REQUEST(4, 7)},   /* USART3_TX */
    {REQUEST(9, 5), REQUEST(10, 5)},  /* USART6_RX */
    {REQUEST(14, 5), REQUEST(15, 5)}, /* USART6_TX */
};

const epg_stm32_uart_t *epg_stm32_uart_find(uint8_t number)
{
    for (size_t i = 0; i < sizeof uarts / sizeof uarts[0]; i++) {
        if (uarts[i].number == number) {
            return &uarts[i];
        }
    }
    return NULL;
}

static bool take(uint32_t request, epg_stm32_stream_t *stream)
{
    if (!epg_stm32_dma_take(STREAM(request), stream)) {
        return false;
    }
    stream->bits = CHANNEL(request) << DMA_SxCR_CHSEL_Pos;
    return true;
}

static bool take_any(uint32_t request, epg_stm32_stream_t *stream)
{
    if (take(request, stream)) {
        return true;
    }
    for (size_t i = 0; i < sizeof second / sizeof second[0]; i++) {
        if (second[i].request == request) {
            return take(second[i].other, stream);
        }
    }
    return false;
}

bool epg_stm32_uart_take_streams(const epg_stm32_uart_t *uart, epg_stm32_stream_t *receive,
                                 epg_stm32_stream_t *transmit)
{
    return take_any(uart->receive_request, receive) && take_any(uart->transmit_request, transmit);
}

bool epg_stm32_dma_reaches(const void *address, size_t size)
{
    /* RM0410, "Memory organization": DTCM (by the AHBS port of the core), SRAM1 and SRAM2; none is ever without clock. */
    const uintptr_t begin = (uintptr_t)address;
    return begin >= RAMDTCM_BASE && begin + size <= SRAM2_BASE + 0x4000U;
}
