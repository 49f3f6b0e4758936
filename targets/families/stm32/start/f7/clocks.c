/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32F7: memories, supply and clocks at the start of a program.
 *
 *     HSE -> / M -> 2 MHz -> * N -> VCO -> / 2 -> core and AHB -> / 4 -> APB1 and its UARTs
 *                                                              -> / 2 -> APB2 and its UARTs
 *
 * The timers of APB1 and APB2 have twice the clock of their bus (RM0410, RCC_DCKCFGR1, TIMPRE = 0).
 */
#include "../start.h"
#include "epg/stm32_device.h"
#include "epg_stm32_target.h"

#include <stdbool.h>

#define CORE EPG_STM32_CLOCK_CORE
#define APB1 (CORE / 4U)
#define APB2 (CORE / 2U)

/** The input of the PLL, as CubeMX chooses it for 8 MHz; then N is the clock of the core in MHz. */
#define INPUT 2000000U
#define DIVIDER_M (EPG_STM32_CLOCK_HSE / INPUT)
#define FACTOR_N (2U * CORE / INPUT)
/** Output Q, the clock of USB, is 48 MHz if the core has 216 MHz or another multiple of 24 MHz, and else less. */
#define DIVIDER_Q ((2U * CORE + 47999999U) / 48000000U)

#define SETTABLE "EPG's start-up code cannot make the clocks of the .tcf: "
_Static_assert(EPG_STM32_CLOCK_HSE % INPUT == 0U && DIVIDER_M >= 2U && DIVIDER_M <= 63U,
               SETTABLE "hse must be a multiple of 2 MHz, and 4 MHz or more");
/* RM0410, RCC_PLLCFGR: the VCO has 100 to 432 MHz. */
_Static_assert(2U * CORE % INPUT == 0U && CORE >= 50000000U && CORE <= 216000000U,
               SETTABLE "core must be 50 to 216 MHz, and a multiple of 1 MHz");
_Static_assert(EPG_STM32_CLOCK_APB1_TIMERS == 2U * APB1, SETTABLE "apb1_timers must be half of core");
_Static_assert(EPG_STM32_CLOCK_APB2_TIMERS == 2U * APB2, SETTABLE "apb2_timers must be that of the core");
_Static_assert(EPG_STM32_CLOCK_USART1 == APB2 && EPG_STM32_CLOCK_USART6 == APB2,
               SETTABLE "usart1 and usart6 must be half of core");
_Static_assert(EPG_STM32_CLOCK_USART2 == APB1 && EPG_STM32_CLOCK_USART3 == APB1 && EPG_STM32_CLOCK_UART4 == APB1 &&
                   EPG_STM32_CLOCK_UART5 == APB1 && EPG_STM32_CLOCK_UART7 == APB1 && EPG_STM32_CLOCK_UART8 == APB1,
               SETTABLE "usart2, usart3, uart4, uart5, uart7 and uart8 must be a quarter of core");

/** Readings until a part of the chip must be ready: at 16 MHz more than 0.05 s. */
#define READINGS 200000U

/** The highest clock of the core without the over-drive (DS11532, general operating conditions). */
#define WITHOUT_OVERDRIVE 180000000U

/** With a supply of 2.7 V or more, one wait state of the flash for each 30 MHz (RM0410, "Read access latency"). */
#define WAIT_STATES ((CORE - 1U) / 30000000U)

static bool wait(const volatile uint32_t *word, uint32_t mask, uint32_t value)
{
    for (uint32_t i = 0; i < READINGS; i++) {
        if ((*word & mask) == value) {
            return true;
        }
    }
    return false;
}

void epg_start_memories(void)
{
    /* After a reset, DTCM, SRAM1 and SRAM2 have their clocks (RM0410, RCC_AHB1ENR). */
}

/** RM0410, RCC, "HSE clock": HSE is a clock at OSC_IN, not a crystal. */
static bool start_hse(void)
{
    RCC->CR |= RCC_CR_HSEBYP;
    RCC->CR |= RCC_CR_HSEON;
    return wait(&RCC->CR, RCC_CR_HSERDY, RCC_CR_HSERDY);
}

/** Voltage scale 1 must be selected before the PLL starts (RM0410, PWR_CR1). */
static void start_pll(void)
{
    RCC->APB1ENR |= RCC_APB1ENR_PWREN;
    (void)RCC->APB1ENR;
    PWR->CR1 |= PWR_CR1_VOS; /* 3: scale 1 */
    /* P = 0 divides by 2. */
    RCC->PLLCFGR = (RCC->PLLCFGR & ~(RCC_PLLCFGR_PLLM | RCC_PLLCFGR_PLLN | RCC_PLLCFGR_PLLP | RCC_PLLCFGR_PLLQ)) |
                   RCC_PLLCFGR_PLLSRC_HSE | DIVIDER_M << RCC_PLLCFGR_PLLM_Pos | FACTOR_N << RCC_PLLCFGR_PLLN_Pos |
                   DIVIDER_Q << RCC_PLLCFGR_PLLQ_Pos;
    RCC->CR |= RCC_CR_PLLON;
}

/** RM0410, PWR, "Entering Over-drive mode": the PLL is on, and the core still has another clock. */
static bool raise_voltage(void)
{
    if (CORE <= WITHOUT_OVERDRIVE) {
        return true;
    }
    PWR->CR1 |= PWR_CR1_ODEN;
    if (!wait(&PWR->CSR1, PWR_CSR1_ODRDY, PWR_CSR1_ODRDY)) {
        return false;
    }
    PWR->CR1 |= PWR_CR1_ODSWEN;
    return wait(&PWR->CSR1, PWR_CSR1_ODSWRDY, PWR_CSR1_ODSWRDY);
}

static bool slow_flash_down(void)
{
    FLASH->ACR = (FLASH->ACR & ~FLASH_ACR_LATENCY) | WAIT_STATES << FLASH_ACR_LATENCY_Pos;
    return wait(&FLASH->ACR, FLASH_ACR_LATENCY, WAIT_STATES << FLASH_ACR_LATENCY_Pos);
}

void epg_start_clocks(void)
{
    if (!start_hse()) {
        return;
    }
    start_pll();
    if (!raise_voltage() || !slow_flash_down() || !wait(&RCC->CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY)) {
        return;
    }
    /* The dividers come first, so that no bus is ever too fast. */
    RCC->CFGR =
        (RCC->CFGR & ~(RCC_CFGR_HPRE | RCC_CFGR_PPRE1 | RCC_CFGR_PPRE2)) | RCC_CFGR_PPRE1_DIV4 | RCC_CFGR_PPRE2_DIV2;
    RCC->CFGR = (RCC->CFGR & ~RCC_CFGR_SW) | RCC_CFGR_SW_PLL;
    (void)wait(&RCC->CFGR, RCC_CFGR_SWS, RCC_CFGR_SWS_PLL);
}
