/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * JIWY on a Nucleo-H743ZI, as an engineer would write it for this one robot with ST's device header, without a generator.
 *
 * The control cycle is the program of the benchmark of the host, runtime/handwritten.c: encoders, H-bridges, tests for
 * values that are not finite, faults, statistics, and wait-free exchanges with main().  Here, its functions for the
 * hardware are accesses to registers, which the compiler inlines.  This file adds the tick, missed ticks and the
 * watchdog.  Parameters, capture, moving by hand, motion guards, communication, and the measurement of stacks are left
 * out.
 *
 * Timers: TIM1 PWM, TIM3 and TIM4 encoders, TIM5 time in microseconds, TIM6 tick.  Registers: RM0433, 38 (TIM1), 39
 * (TIM2 to TIM5), 41 (TIM6), 11 (GPIO), 45 (IWDG).
 */
#include "stm32h7xx.h"

#define TIMERS_HZ 200000000U
#define PWM_TOP (TIMERS_HZ / 20000U - 1U) /* 20 kHz */
#define TICK_PRESCALER 4U
#define TICK_TOP (TIMERS_HZ / TICK_PRESCALER / 1000U - 1U) /* 1 ms */
#define ENCODER_MODE (TIM_SMCR_SMS_0 | TIM_SMCR_SMS_1)     /* encoder mode 3 */
#define WATCHDOG_FEED 0xAAAAU

#include "../runtime/handwritten.c"

/* Hardware, as the control cycle sees it -------------------------------------------------------------------------- */

/* Decoders: slot 0 is pan, TIM4 on PD12 and PD13; slot 1 is tilt, TIM3 on PC6 and PC7. */
static inline TIM_TypeDef *timer_of(const epg_port_quadrature_t *decoder)
{
    return decoder->slot == 0U ? TIM4 : TIM3;
}

static uint32_t counts[2];

uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    uint32_t *count = &counts[decoder->slot];
    *count += (uint32_t)(int32_t)(int16_t)(uint16_t)(timer_of(decoder)->CNT - *count);
    return *count;
}

bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    const TIM_TypeDef *timer = timer_of(decoder);
    return (timer->CR1 & TIM_CR1_CEN) != 0U && (timer->SMCR & TIM_SMCR_SMS) == ENCODER_MODE;
}

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    TIM_TypeDef *timer = timer_of(decoder);
    timer->CCMR1 = TIM_CCMR1_CC1S_0 | TIM_CCMR1_CC2S_0;
    timer->SMCR = ENCODER_MODE;
    timer->CR1 = TIM_CR1_CEN;
}

void epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level)
{
    (&TIM1->CCR1)[pwm->slot] = level;
}

void epg_port_pwm_start(const epg_port_pwm_t *pwm)
{
    (void)pwm; /* start_peripherals() */
}

/* Directions: PF13 and PF15 of pan, PE13 and PF14 of tilt. */
void epg_port_output_write(uint8_t pin, bool level)
{
    const uint32_t bit = pin == PAN_A ? 1U << 13 : pin == PAN_B ? 1U << 15 : pin == TILT_A ? 1U << 13 : 1U << 14;
    (pin == TILT_A ? GPIOE : GPIOF)->BSRR = level ? bit : bit << 16;
}

void epg_port_output_start(uint8_t pin, bool level)
{
    epg_port_output_write(pin, level);
}

static uint64_t time_us;
static uint32_t time_before;

/* Called in the tick only. */
uint64_t epg_port_time_ns(void)
{
    const uint32_t now = TIM5->CNT;
    time_us += now - time_before;
    time_before = now;
    return time_us * 1000U;
}

/* The tick -------------------------------------------------------------------------------------------------------- */

static uint64_t due_ns;
static atomic_bool running;

void TIM6_DAC_IRQHandler(void);
void TIM6_DAC_IRQHandler(void)
{
    TIM6->SR = ~TIM_SR_UIF;
    (void)TIM6->SR;
    __DSB();
    const uint64_t now_ns = epg_port_time_ns();
    uint32_t missed = 0;
    due_ns = atomic_load(&running) ? due_ns + PERIOD_NS : now_ns;
    atomic_store(&running, true);
    while (now_ns > due_ns + PERIOD_NS && missed < UINT32_MAX) {
        due_ns += PERIOD_NS;
        missed++;
    }
    glue_cycle(due_ns, missed);
    if (silence < 1000U) {
        IWDG1->KR = WATCHDOG_FEED;
    }
}

/* The core has 400 MHz, the timers 200 MHz: PLL1 from the ST-LINK's 8 MHz (RM0433, 6.8 and 8.7). */
static void start_clocks(void)
{
    PWR->CR3 = (PWR->CR3 | PWR_CR3_LDOEN) & ~PWR_CR3_BYPASS;
    while ((PWR->CSR1 & PWR_CSR1_ACTVOSRDY) == 0U) {
    }
    PWR->D3CR |= PWR_D3CR_VOS;
    while ((PWR->D3CR & PWR_D3CR_VOSRDY) == 0U) {
    }
    RCC->CR |= RCC_CR_HSEBYP;
    RCC->CR |= RCC_CR_HSEON;
    while ((RCC->CR & RCC_CR_HSERDY) == 0U) {
    }
    RCC->PLLCKSELR = (1U << RCC_PLLCKSELR_DIVM1_Pos) | RCC_PLLCKSELR_PLLSRC_HSE;
    RCC->PLLCFGR = (3U << RCC_PLLCFGR_PLL1RGE_Pos) | RCC_PLLCFGR_DIVP1EN;
    RCC->PLL1DIVR = (99U << RCC_PLL1DIVR_N1_Pos) | (1U << RCC_PLL1DIVR_P1_Pos) | (1U << RCC_PLL1DIVR_Q1_Pos) |
                    (1U << RCC_PLL1DIVR_R1_Pos);
    RCC->CR |= RCC_CR_PLL1ON;
    while ((RCC->CR & RCC_CR_PLL1RDY) == 0U) {
    }
    FLASH->ACR = FLASH_ACR_WRHIGHFREQ_1 | FLASH_ACR_LATENCY_2WS;
    while ((FLASH->ACR & FLASH_ACR_LATENCY) != FLASH_ACR_LATENCY_2WS) {
    }
    RCC->D1CFGR = RCC_D1CFGR_HPRE_DIV2 | RCC_D1CFGR_D1PPRE_DIV2;
    RCC->D2CFGR = RCC_D2CFGR_D2PPRE1_DIV2 | RCC_D2CFGR_D2PPRE2_DIV2;
    RCC->D3CFGR = RCC_D3CFGR_D3PPRE_DIV2;
    RCC->CFGR = (RCC->CFGR & ~RCC_CFGR_SW) | RCC_CFGR_SW_PLL1;
    while ((RCC->CFGR & RCC_CFGR_SWS) != RCC_CFGR_SWS_PLL1) {
    }
}

static void start_peripherals(void)
{
    RCC->AHB4ENR |= RCC_AHB4ENR_GPIOCEN | RCC_AHB4ENR_GPIODEN | RCC_AHB4ENR_GPIOEEN | RCC_AHB4ENR_GPIOFEN;
    RCC->APB1LENR |= RCC_APB1LENR_TIM3EN | RCC_APB1LENR_TIM4EN | RCC_APB1LENR_TIM5EN | RCC_APB1LENR_TIM6EN;
    RCC->APB2ENR |= RCC_APB2ENR_TIM1EN;
    (void)RCC->APB2ENR;

    GPIOC->MODER = (GPIOC->MODER & ~0x0000F000U) | 0x0000A000U; /* PC6, PC7: alternate function 2 */
    GPIOC->AFR[0] = (GPIOC->AFR[0] & ~0xFF000000U) | 0x22000000U;
    GPIOD->MODER = (GPIOD->MODER & ~0x0F000000U) | 0x0A000000U; /* PD12, PD13: alternate function 2 */
    GPIOD->AFR[1] = (GPIOD->AFR[1] & ~0x00FF0000U) | 0x00220000U;
    GPIOE->MODER = (GPIOE->MODER & ~0x0CCC0000U) | 0x04880000U; /* PE9, PE11: function 1; PE13: output */
    GPIOE->AFR[1] = (GPIOE->AFR[1] & ~0x0000F0F0U) | 0x00001010U;
    GPIOF->MODER = (GPIOF->MODER & ~0xFC000000U) | 0x54000000U; /* PF13, PF14, PF15: outputs */

    TIM1->ARR = PWM_TOP;
    TIM1->CCMR1 = TIM_CCMR1_OC1M_1 | TIM_CCMR1_OC1M_2 | TIM_CCMR1_OC1PE | TIM_CCMR1_OC2M_1 | TIM_CCMR1_OC2M_2 |
                  TIM_CCMR1_OC2PE; /* PWM mode 1, preloaded */
    TIM1->CCER = TIM_CCER_CC1E | TIM_CCER_CC2E;
    TIM1->EGR = TIM_EGR_UG;
    TIM1->BDTR = TIM_BDTR_MOE;
    TIM1->CR1 = TIM_CR1_CEN;
    TIM5->PSC = TIMERS_HZ / 1000000U - 1U;
    TIM5->EGR = TIM_EGR_UG;
    TIM5->CR1 = TIM_CR1_CEN;
    TIM6->PSC = TICK_PRESCALER - 1U;
    TIM6->ARR = TICK_TOP;
    TIM6->EGR = TIM_EGR_UG;
    TIM6->SR = 0;
    TIM6->DIER = TIM_DIER_UIE;
}

static void start_watchdog(void)
{
    IWDG1->KR = 0xCCCCU; /* starts it */
    IWDG1->KR = 0x5555U;
    IWDG1->PR = 3U;    /* 32 kHz / 32 */
    IWDG1->RLR = 100U; /* 100 ms */
    while (IWDG1->SR != 0U) {
    }
    IWDG1->KR = WATCHDOG_FEED;
}

int main(void)
{
    start_clocks();
    start_peripherals();
    glue_start();
    start_watchdog();
    NVIC_SetPriority(TIM6_DAC_IRQn, 0);
    NVIC_EnableIRQ(TIM6_DAC_IRQn);
    TIM6->CR1 = TIM_CR1_CEN;
    for (;;) {
        double published[GLUE_MONITORED];
        epg_status_t status;
        (void)glue_monitor(published);
        (void)glue_status(&status);
        (void)glue_receive(0, 0.0, 0, true);
        atomic_store(&alive, atomic_load(&alive) + 1U);
        __WFI();
    }
}
