/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32H7: the UARTs, the streams that serve them, and the memories that a DMA reaches.
 *
 * DMAMUX1 connects each request to any stream: its channels 0 to 7 belong to DMA1, and 8 to 15 to DMA2 (RM0433,
 * 17.3.1).  STM32CubeMX gives the streams to its users from DMA1's stream 0 upwards.  EPG takes the first free one from
 * stream 7 downwards, so that code that is started later finds its own streams free.
 */
#include "../uarts.h"

#include "../parts.h"

/*
 * Interrupts: RM0433, 19.1.2.  Bits of clock and reset: 8.7.  Requests: 17.3.2, "DMAMUX1: assignment of multiplexer
 * inputs to resources".
 */
#define ON_APB1(kind, n, interrupt_, request)                                                                          \
    {                                                                                                                  \
        .number = (n), .receive_request = (request), .transmit_request = (request) + 1U, .interrupt = (interrupt_),    \
        .registers = kind##n, .clock = &RCC->APB1LENR, .reset = &RCC->APB1LRSTR, .bit = RCC_APB1LENR_##kind##n##EN,    \
    }
#define ON_APB2(kind, n, interrupt_, request)                                                                          \
    {                                                                                                                  \
        .number = (n), .receive_request = (request), .transmit_request = (request) + 1U, .interrupt = (interrupt_),    \
        .registers = kind##n, .clock = &RCC->APB2ENR, .reset = &RCC->APB2RSTR, .bit = RCC_APB2ENR_##kind##n##EN,       \
    }

static const epg_stm32_uart_t uarts[] = {
    ON_APB2(USART, 1, USART1_IRQn, 41), ON_APB1(USART, 2, USART2_IRQn, 43), ON_APB1(USART, 3, USART3_IRQn, 45),
    ON_APB1(UART, 4, UART4_IRQn, 63),   ON_APB1(UART, 5, UART5_IRQn, 65),   ON_APB2(USART, 6, USART6_IRQn, 71),
    ON_APB1(UART, 7, UART7_IRQn, 79),   ON_APB1(UART, 8, UART8_IRQn, 81),
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

bool epg_stm32_uart_take_streams(const epg_stm32_uart_t *uart, epg_stm32_stream_t *receive,
                                 epg_stm32_stream_t *transmit)
{
    static const uint8_t order[EPG_STM32_STREAMS] = {7, 6, 5, 4, 3, 2, 1, 0, 15, 14, 13, 12, 11, 10, 9, 8};
    DMAMUX_Channel_TypeDef *first = NULL;
    for (size_t i = 0; i < EPG_STM32_STREAMS; i++) {
        DMAMUX_Channel_TypeDef *channel = DMAMUX1_Channel0 + order[i];
        if ((channel->CCR & DMAMUX_CxCR_DMAREQ_ID) != 0U ||
            !epg_stm32_dma_take(order[i], first == NULL ? receive : transmit)) {
            continue;
        }
        if (first == NULL) {
            first = channel;
        } else {
            /* RM0433, 15.5.5: TRBUFF must be set if the stream serves a UART.  Without it the stream could lock up. */
            receive->bits = DMA_SxCR_TRBUFF;
            transmit->bits = DMA_SxCR_TRBUFF;
            first->CCR = uart->receive_request;
            channel->CCR = uart->transmit_request;
            return true;
        }
    }
    return false;
}

bool epg_stm32_dma_reaches(const void *address, size_t size)
{
    /* RM0433, 2.3.2 and 2.4: AXI SRAM, SRAM1 to SRAM3 in domain D2, SRAM4 in domain D3 */
    static const struct {
        uintptr_t begin;
        uintptr_t end;
    } memories[] = {{0x24000000U, 0x24080000U}, {0x30000000U, 0x30048000U}, {0x38000000U, 0x38010000U}};
    const uintptr_t begin = (uintptr_t)address;
    for (size_t i = 0; i < sizeof memories / sizeof memories[0]; i++) {
        if (begin >= memories[i].begin && begin + size <= memories[i].end) {
            /* SRAM1 to SRAM3 have no clock after a reset (RM0433, 8.7.42). */
            const uint32_t before = epg_stm32_enter();
            RCC->AHB2ENR |= RCC_AHB2ENR_SRAM1EN | RCC_AHB2ENR_SRAM2EN | RCC_AHB2ENR_SRAM3EN;
            epg_stm32_leave(before);
            (void)RCC->AHB2ENR;
            return true;
        }
    }
    return false;
}
