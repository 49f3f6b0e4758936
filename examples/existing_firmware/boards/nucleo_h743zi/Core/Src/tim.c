/* Timers: RM0433, sections 38 (TIM1), 39 (TIM4, TIM5) and 42 (TIM6). */
#include "main.h"
#include "registers.h"

#define CR1_CEN (1u << 0)
#define CR1_ARPE (1u << 7)
#define EGR_UG (1u << 0)

/** PWM on PE9: mode 1, with preload, so that a level acts from the next period on. */
void MX_TIM1_Init(uint32_t prescaler, uint32_t top)
{
    RCC_APB2ENR |= 1u << 0;
    (void)RCC_APB2ENR;
    TIM1->psc = prescaler - 1u;
    TIM1->arr = top;
    TIM1->ccr1 = 0;
    TIM1->ccmr1 = 6u << 4 | 1u << 3; /* OC1M, OC1PE */
    TIM1->ccer = 1u << 0;            /* CC1E */
    TIM1->bdtr = 1u << 15;           /* MOE */
    TIM1->egr = EGR_UG;
    TIM1->cr1 = CR1_ARPE | CR1_CEN;
    pin_function(GPIOE, 9, 1);
}

/** Encoder on PD12 and PD13: mode 3 counts all edges of both. The counter has 16 bits. */
void MX_TIM4_Init(void)
{
    RCC_APB1LENR |= 1u << 2;
    (void)RCC_APB1LENR;
    TIM4->smcr = 3u;                                      /* SMS */
    TIM4->ccmr1 = 1u << 0 | 1u << 8 | 3u << 4 | 3u << 12; /* CC1S, CC2S: inputs 1 and 2; a filter of 8 clocks */
    TIM4->arr = 0xFFFFu;
    TIM4->cr1 = CR1_CEN;
    pin_function(GPIOD, 12, 2);
    pin_function(GPIOD, 13, 2);
}

/** A counter of microseconds with 32 bits. */
void MX_TIM5_Init(void)
{
    RCC_APB1LENR |= 1u << 3;
    (void)RCC_APB1LENR;
    TIM5->psc = TIMERS_HZ / 1000000 - 1;
    TIM5->arr = 0xFFFFFFFFu;
    TIM5->egr = EGR_UG;
    TIM5->cr1 = CR1_CEN;
}

/** The tick: 1 kHz, priority 0, the highest. */
void MX_TIM6_Init(void)
{
    RCC_APB1LENR |= 1u << 4;
    (void)RCC_APB1LENR;
    TIM6->psc = TIMERS_HZ / 1000000 - 1;
    TIM6->arr = 1000 - 1;
    TIM6->egr = EGR_UG;
    TIM6->sr = 0;
    TIM6->dier = 1u << 0; /* UIE */
    interrupt_enable(54, 0);
    TIM6->cr1 = CR1_CEN;
}

void motor_pwm(uint32_t compare)
{
    TIM1->ccr1 = compare;
}

uint16_t encoder_count(void)
{
    return (uint16_t)TIM4->cnt;
}

uint32_t microseconds(void)
{
    return TIM5->cnt;
}

void tick_acknowledge(void)
{
    TIM6->sr = 0;
    (void)TIM6->sr; /* the write has arrived before the handler returns */
}
