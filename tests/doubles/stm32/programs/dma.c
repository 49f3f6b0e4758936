/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A UART by DMA: received into a ring, sent back from a buffer.
 *
 * `mode` is written by the test before main(): see the bits below.
 */
#include "small.h"

#include <string.h>

enum { RING = 64, CACHED = 1, CLEAN = 2, DROP = 4, UNCACHED_REGION = 8, RECEIVE_IN_DTCM = 16, COPY = 32 };

__attribute__((section(".noinit"))) volatile uint32_t mode;
__attribute__((section(".axi"), aligned(256))) uint8_t ring[RING], answer[RING];
__attribute__((section(".sram1"), aligned(32))) uint32_t copied[8];
static uint8_t near_core[RING];
static const uint32_t original[8] = {1, 2, 3, 4, 5, 6, 7, 8};
volatile uint32_t halves, completes, errors, taken, copy_done;

static void on_receive(void)
{
    const uint32_t flags = DMA1->LISR;
    DMA1->LIFCR = flags;
    halves += flags >> DMA_LISR_HTIF0_Pos & 1U;
    completes += flags >> DMA_LISR_TCIF0_Pos & 1U;
    errors += flags >> DMA_LISR_TEIF0_Pos & 1U;
}

static void on_copy(void)
{
    copy_done += DMA2->HISR >> DMA_HISR_TCIF5_Pos & 1U;
    DMA2->HIFCR = 0xFFFFFFFFU;
}

static void on_uart(void)
{
    USART3->ICR = USART_ICR_IDLECF;
}

/** Sends `size` bytes and waits for the end. */
static void answer_by_dma(uint32_t size)
{
    DMA1_Stream1->CR = 0;
    while (DMA1_Stream1->CR & DMA_SxCR_EN) {
    }
    DMA1->LIFCR = 0x3DU << 6;
    DMA1_Stream1->NDTR = size;
    DMA1_Stream1->M0AR = (uint32_t)answer;
    DMA1_Stream1->CR = DMA_SxCR_DIR_0 | DMA_SxCR_MINC;
    DMA1_Stream1->CR |= DMA_SxCR_EN;
    while (!(DMA1->LISR & DMA_LISR_TCIF1)) {
    }
}

static void uncache_axi(void)
{
    MPU->RNR = 0;
    MPU->RBAR = 0x24000000U;
    MPU->RASR = 1U << MPU_RASR_TEX_Pos | 3U << MPU_RASR_AP_Pos | 18U << MPU_RASR_SIZE_Pos | MPU_RASR_ENABLE_Msk;
    MPU->CTRL = MPU_CTRL_PRIVDEFENA_Msk | MPU_CTRL_ENABLE_Msk;
    __DSB();
    __ISB();
}

static void use(IRQn_Type interrupt, void (*handler)(void))
{
    set_handler(interrupt, handler);
    NVIC_EnableIRQ(interrupt);
}

int main(void)
{
    memset(ring, 0, sizeof ring);
    memset(answer, 0, sizeof answer);
    if (mode & UNCACHED_REGION)
        uncache_axi();
    if (mode & CACHED)
        SCB_EnableDCache();
    RCC->AHB1ENR |= RCC_AHB1ENR_DMA1EN | RCC_AHB1ENR_DMA2EN;
    RCC->APB1LENR |= RCC_APB1LENR_USART3EN;
    use(DMA1_Stream0_IRQn, on_receive);
    use(DMA2_Stream5_IRQn, on_copy);
    use(USART3_IRQn, on_uart);
    DMAMUX1_Channel0->CCR = 45;
    DMAMUX1_Channel1->CCR = 46;
    DMA1_Stream0->PAR = (uint32_t)&USART3->RDR;
    DMA1_Stream0->M0AR = (uint32_t)((mode & RECEIVE_IN_DTCM) ? near_core : ring);
    DMA1_Stream0->NDTR = RING;
    DMA1_Stream0->CR = DMA_SxCR_MINC | DMA_SxCR_CIRC | DMA_SxCR_HTIE | DMA_SxCR_TCIE | DMA_SxCR_TEIE;
    DMA1_Stream0->CR |= DMA_SxCR_EN;
    DMA1_Stream1->PAR = (uint32_t)&USART3->TDR;
    USART3->BRR = 64;
    USART3->CR3 = USART_CR3_DMAR | USART_CR3_DMAT;
    USART3->CR1 = USART_CR1_UE | USART_CR1_RE | USART_CR1_TE | USART_CR1_IDLEIE;
    if (mode & COPY) {
        DMA2_Stream5->PAR = (uint32_t)original;
        DMA2_Stream5->M0AR = (uint32_t)copied;
        DMA2_Stream5->NDTR = 8;
        DMA2_Stream5->CR = DMA_SxCR_DIR_1 | DMA_SxCR_MINC | DMA_SxCR_PINC | DMA_SxCR_TCIE | 2U << DMA_SxCR_PSIZE_Pos |
                           2U << DMA_SxCR_MSIZE_Pos;
        DMA2_Stream5->CR |= DMA_SxCR_EN;
    }
    for (;;) {
        __WFI();
        const uint32_t at = (RING - DMA1_Stream0->NDTR) % RING;
        uint32_t size = 0;
        if (mode & DROP)
            SCB_InvalidateDCache_by_Addr(ring, RING);
        for (; taken % RING != at; taken++)
            answer[size++] = (uint8_t)(ring[taken % RING] + 1U);
        if (mode & CLEAN)
            SCB_CleanDCache_by_Addr((uint32_t *)answer, RING);
        if (size > 0U)
            answer_by_dma(size);
    }
}
