/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams of the controllers DMA1 and DMA2 (RM0433, 15), which move bytes between memory and a peripheral.
 *
 * A stream has a number here: 0 to 7 are those of DMA1, 8 to 15 those of DMA2.
 *
 * Both controllers reach the memories on the AXI and AHB buses, but not ITCM.  They do not reach DTCM on STM32H7
 * (RM0433, 2.1.1), and do on STM32F7.
 *
 * Buffers are placed by EPG_STM32_DMA (parts.h), begin at a line of the data cache, and share no line with other data.
 */
#ifndef EPG_STM32_DMA_H
#define EPG_STM32_DMA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/stm32_device.h"

#define EPG_STM32_STREAMS 16U

typedef struct epg_stm32_stream {
    DMA_Stream_TypeDef *registers;
    volatile uint32_t *flags; /**< LISR or HISR */
    volatile uint32_t *clear; /**< LIFCR or HIFCR */
    uint32_t shift;           /**< position of the stream's flags in these registers */
    uint32_t bits;            /**< bits of its register CR that the series needs for its request */
    IRQn_Type interrupt;
} epg_stm32_stream_t;

/** Flags of a stream, as epg_stm32_dma_flags() returns them (RM0433, 15.5.1). */
#define EPG_STM32_DMA_HALF DMA_LISR_HTIF0
#define EPG_STM32_DMA_COMPLETE DMA_LISR_TCIF0

/** Enables the clocks of both controllers.  Called before the functions below. */
void epg_stm32_dma_clock(void);

/**
 * Takes stream `number`.  Returns false if the stream belongs to other code: the generator knows this, or other code has
 * set up the stream or enabled its interrupt.
 */
bool epg_stm32_dma_take(uint32_t number, epg_stm32_stream_t *stream);

/** Returns the flags of a stream, and clears them. */
uint32_t epg_stm32_dma_flags(const epg_stm32_stream_t *stream);

/** Disables a stream, waits until its transfer has ended, and clears its flags.  False if the transfer does not end. */
bool epg_stm32_dma_stop(const epg_stm32_stream_t *stream);

/** True if the DMA controllers reach all of `size` bytes at `address`.  Enables the clock of that memory, too. */
bool epg_stm32_dma_reaches(const void *address, size_t size);

#endif
