/* SPDX-License-Identifier: Apache-2.0 */
/** @file A timer that interrupts a loop of floating-point sums, and a UART that sends back what it receives. */
#include "small.h"

volatile uint32_t ticks, rounds, wrong;
volatile double sum_in_interrupt;

static void tick(void)
{
    TIM6->SR = 0;
    ticks++;
    sum_in_interrupt += 0.5 * (double)ticks;
}

static void receive(void)
{
    if (USART3->ISR & USART_ISR_RXNE_RXFNE)
        USART3->TDR = USART3->RDR + 1U;
}

static double series(void)
{
    double sum = 0.0;
    for (int i = 1; i < 40; i++)
        sum += 1.0 / (double)i;
    return sum;
}

int main(void)
{
    double expected = series();

    RCC->APB1LENR |= RCC_APB1LENR_TIM6EN | RCC_APB1LENR_USART3EN;
    set_handler(TIM6_DAC_IRQn, tick);
    set_handler(USART3_IRQn, receive);
    NVIC_SetPriority(TIM6_DAC_IRQn, 0);
    NVIC_SetPriority(USART3_IRQn, 2);
    NVIC_EnableIRQ(TIM6_DAC_IRQn);
    NVIC_EnableIRQ(USART3_IRQn);
    TIM6->PSC = 63;
    TIM6->ARR = 999;
    TIM6->EGR = TIM_EGR_UG;
    TIM6->SR = 0;
    TIM6->DIER = TIM_DIER_UIE;
    TIM6->CR1 = TIM_CR1_CEN;
    USART3->BRR = 64000000 / 115200;
    USART3->CR1 = USART_CR1_UE | USART_CR1_RE | USART_CR1_TE | USART_CR1_RXNEIE_RXFNEIE;
    for (;;) {
        if (series() != expected)
            wrong++;
        rounds++;
    }
}
