/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The UARTs of a series of chips, and the streams of the DMA that serve them.  `<series>/uarts.c` has them.
 */
#ifndef EPG_STM32_UARTS_H
#define EPG_STM32_UARTS_H

#include "dma.h"

/** A UART of the chip. */
typedef struct epg_stm32_uart {
    uint8_t number; /**< ST's: USART3 is 3, UART4 is 4 */
    uint8_t
        receive_request; /**< its request for the DMA by which it gives a received byte; the series has the numbers */
    uint8_t transmit_request; /**< its request for the DMA by which it asks for a byte to send */
    IRQn_Type interrupt;
    USART_TypeDef *registers;
    volatile uint32_t *clock; /**< register of RCC that enables the clock */
    volatile uint32_t *reset; /**< register of RCC that resets the UART */
    uint32_t bit;             /**< its bit in both registers */
} epg_stm32_uart_t;

/** The UART with ST's number `number`; NULL if the chip does not have it. */
const epg_stm32_uart_t *epg_stm32_uart_find(uint8_t number);

/**
 * Takes two streams that no other code uses, and connects them to the requests of a UART.  False if there are not two.
 */
bool epg_stm32_uart_take_streams(const epg_stm32_uart_t *uart, epg_stm32_stream_t *receive,
                                 epg_stm32_stream_t *transmit);

#endif
