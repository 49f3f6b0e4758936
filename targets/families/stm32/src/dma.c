/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams of the controllers DMA1 and DMA2.
 */
#include "dma.h"

#include "parts.h"

/** Streams of a controller. */
#define STREAMS 8U
/** A transfer of one byte ends within this number of readings of a register. */
#define STOP_READINGS 10000U
/** All flags of a stream (RM0433, 15.5.1). */
#define FLAGS (DMA_LISR_FEIF0 | DMA_LISR_DMEIF0 | DMA_LISR_TEIF0 | EPG_STM32_DMA_HALF | EPG_STM32_DMA_COMPLETE)

static const IRQn_Type interrupts[EPG_STM32_STREAMS] = {
    DMA1_Stream0_IRQn, DMA1_Stream1_IRQn, DMA1_Stream2_IRQn, DMA1_Stream3_IRQn, DMA1_Stream4_IRQn, DMA1_Stream5_IRQn,
    DMA1_Stream6_IRQn, DMA1_Stream7_IRQn, DMA2_Stream0_IRQn, DMA2_Stream1_IRQn, DMA2_Stream2_IRQn, DMA2_Stream3_IRQn,
    DMA2_Stream4_IRQn, DMA2_Stream5_IRQn, DMA2_Stream6_IRQn, DMA2_Stream7_IRQn,
};

void epg_stm32_dma_clock(void)
{
    const uint32_t before = epg_stm32_enter();
    RCC->AHB1ENR |= RCC_AHB1ENR_DMA1EN | RCC_AHB1ENR_DMA2EN;
    epg_stm32_leave(before);
    (void)RCC->AHB1ENR; /* the clock runs two cycles later (RM0433, 8.5.11) */
}

/** Fills in the description of stream `number`. */
static void describe(uint32_t number, epg_stm32_stream_t *stream)
{
    /* RM0433, 15.5: the flags of four streams share a register, at these bits. */
    static const uint8_t shifts[4] = {0, 6, 16, 22};
    DMA_TypeDef *controller = number < STREAMS ? DMA1 : DMA2;
    DMA_Stream_TypeDef *first = number < STREAMS ? DMA1_Stream0 : DMA2_Stream0;
    const uint32_t index = number % STREAMS;
    *stream = (epg_stm32_stream_t){
        .registers = first + index,
        .flags = index < 4U ? &controller->LISR : &controller->HISR,
        .clear = index < 4U ? &controller->LIFCR : &controller->HIFCR,
        .shift = shifts[index % 4U],
        .interrupt = interrupts[number],
    };
}

bool epg_stm32_dma_take(uint32_t number, epg_stm32_stream_t *stream)
{
    describe(number, stream);
    return (epg_stm32_hardware.other_streams & 1U << number) == 0U && stream->registers->CR == 0U &&
           stream->registers->PAR == 0U && NVIC_GetEnableIRQ(stream->interrupt) == 0U;
}

uint32_t epg_stm32_dma_flags(const epg_stm32_stream_t *stream)
{
    const uint32_t flags = *stream->flags >> stream->shift & FLAGS;
    *stream->clear = flags << stream->shift;
    return flags;
}

bool epg_stm32_dma_stop(const epg_stm32_stream_t *stream)
{
    stream->registers->CR &= ~DMA_SxCR_EN;
    for (uint32_t i = 0; i < STOP_READINGS; i++) {
        if ((stream->registers->CR & DMA_SxCR_EN) == 0U) {
            *stream->clear = FLAGS << stream->shift;
            return true;
        }
    }
    return false;
}
