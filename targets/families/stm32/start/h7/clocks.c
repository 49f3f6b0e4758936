/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32H7: memories, supply and clocks at the start of a program.
 *
 *     HSE -> / M -> 2 MHz -> * N -> VCO -> / 2 -> core -> / 1, 2 -> AHB -> / 2 -> APB1 ... APB4, UARTs
 *
 * The timers of an APB that divides by 2 have the clock of the AHB (RM0433, 8.5.6).
 */
#include "../start.h"
#include "epg/stm32_device.h"
#include "epg_stm32_target.h"

#include <stdbool.h>

#define CORE EPG_STM32_CLOCK_CORE
#define AHB EPG_STM32_CLOCK_APB1_TIMERS

/** The input of the PLL, as CubeMX chooses it for 8 MHz; then N is the clock of the core in MHz. */
#define INPUT 2000000U
#define DIVIDER_M (EPG_STM32_CLOCK_HSE / INPUT)
#define FACTOR_N (2U * CORE / INPUT)

#define SETTABLE "EPG's start-up code cannot make the clocks of the .tcf: "
_Static_assert(EPG_STM32_CLOCK_HSE % INPUT == 0U && DIVIDER_M >= 1U && DIVIDER_M <= 63U,
               SETTABLE "hse must be a multiple of 2 MHz");
/* RM0433, 8.5.5: the VCO has 192 to 836 MHz, from revision V on 960 MHz (DS12110, PLL characteristics). */
_Static_assert(2U * CORE % INPUT == 0U && 2U * CORE >= 192000000U && 2U * CORE <= 960000000U,
               SETTABLE "core must be 96 to 480 MHz, and a multiple of 1 MHz");
_Static_assert(CORE == AHB || CORE == 2U * AHB, SETTABLE "apb1_timers must be that of the core, or half of it");
_Static_assert(AHB <= 240000000U, SETTABLE "apb1_timers must be 240 MHz at most");
_Static_assert(EPG_STM32_CLOCK_APB2_TIMERS == AHB, SETTABLE "apb2_timers must be apb1_timers");
_Static_assert(2U * EPG_STM32_CLOCK_UART1_6 == AHB && 2U * EPG_STM32_CLOCK_UART2_8 == AHB,
               SETTABLE "uart1_6 and uart2_8 must be half of apb1_timers");

/** Readings until a part of the chip must be ready: at 64 MHz some 0.04 s.  The slowest takes 2 ms (DS12110, 6.3). */
#define READINGS 200000U

/** DBGMCU_IDC, bits 31 to 16: from revision V on, the core can have more than 400 MHz; older ones are below 0x2000. */
#define REVISION_V 0x2003U
#define REVISION_X 0x2000U

static bool wait(const volatile uint32_t *word, uint32_t mask, uint32_t value)
{
    for (uint32_t i = 0; i < READINGS; i++) {
        if ((*word & mask) == value) {
            return true;
        }
    }
    return false;
}

static uint32_t revision(void)
{
    return DBGMCU->IDCODE >> DBGMCU_IDCODE_REV_ID_Pos;
}

void epg_start_memories(void)
{
    /* RM0433, 8.7.42: SRAM1, which has the buffers of the DMA, is off after a reset. */
    RCC->AHB2ENR |= RCC_AHB2ENR_SRAM1EN;
    (void)RCC->AHB2ENR;
    if (revision() < REVISION_X) {
        /* Errata sheet ES0392, "Reading from AXI SRAM might lead to data read corruption": READ_ISS_OVERRIDE = 1 of the
         * interconnect's target 7 lets it do one reading after the other. */
        *(volatile uint32_t *)(GPV_BASE + 0x8108U) = 1U;
    }
    __DSB();
}

/** RM0433, 6.4.1 and 6.6.2: the linear regulator supplies the core; voltage scale 1, above 400 MHz scale 0. */
static bool raise_voltage(void)
{
    PWR->CR3 = (PWR->CR3 & ~(PWR_CR3_SCUEN | PWR_CR3_BYPASS)) | PWR_CR3_LDOEN;
    if (!wait(&PWR->CSR1, PWR_CSR1_ACTVOSRDY, PWR_CSR1_ACTVOSRDY)) {
        return false;
    }
    PWR->D3CR |= PWR_D3CR_VOS; /* 3: scale 1 */
    (void)PWR->D3CR;
    if (!wait(&PWR->D3CR, PWR_D3CR_VOSRDY, PWR_D3CR_VOSRDY)) {
        return false;
    }
    if (CORE > 400000000U) {
        if (revision() < REVISION_V) {
            return false;
        }
        RCC->APB4ENR |= RCC_APB4ENR_SYSCFGEN;
        (void)RCC->APB4ENR;
        SYSCFG->PWRCR |= SYSCFG_PWRCR_ODEN;
        (void)SYSCFG->PWRCR;
        return wait(&PWR->D3CR, PWR_D3CR_VOSRDY, PWR_D3CR_VOSRDY);
    }
    return true;
}

/** RM0433, 8.5.2: HSE is a clock at OSC_IN, not a crystal. */
static bool start_hse(void)
{
    RCC->CR |= RCC_CR_HSEBYP;
    RCC->CR |= RCC_CR_HSEON;
    return wait(&RCC->CR, RCC_CR_HSERDY, RCC_CR_HSERDY);
}

/** RM0433, 8.5.5, "PLL initialization phase"; only output P is on. */
static bool start_pll(void)
{
    RCC->PLLCKSELR = (RCC->PLLCKSELR & ~(RCC_PLLCKSELR_PLLSRC_Msk | RCC_PLLCKSELR_DIVM1_Msk)) |
                     2U << RCC_PLLCKSELR_PLLSRC_Pos | DIVIDER_M << RCC_PLLCKSELR_DIVM1_Pos;
    /* Input 2 to 4 MHz, wide range of the VCO, no fraction. */
    RCC->PLLCFGR = (RCC->PLLCFGR & ~(RCC_PLLCFGR_PLL1RGE_Msk | RCC_PLLCFGR_PLL1VCOSEL_Msk | RCC_PLLCFGR_PLL1FRACEN_Msk |
                                     RCC_PLLCFGR_DIVP1EN_Msk | RCC_PLLCFGR_DIVQ1EN_Msk | RCC_PLLCFGR_DIVR1EN_Msk)) |
                   1U << RCC_PLLCFGR_PLL1RGE_Pos | RCC_PLLCFGR_DIVP1EN;
    RCC->PLL1DIVR = (FACTOR_N - 1U) << RCC_PLL1DIVR_N1_Pos | 1U << RCC_PLL1DIVR_P1_Pos | 1U << RCC_PLL1DIVR_Q1_Pos |
                    1U << RCC_PLL1DIVR_R1_Pos;
    RCC->CR |= RCC_CR_PLL1ON;
    return wait(&RCC->CR, RCC_CR_PLL1RDY, RCC_CR_PLL1RDY);
}

/** RM0433, 4.3.8, table "Flash recommended number of wait states and programming delay", for the scales 1 and 0. */
static bool slow_flash_down(void)
{
    const uint32_t latency = AHB > 210000000U ? 4U : 2U;
    FLASH->ACR = latency << FLASH_ACR_LATENCY_Pos | 2U << FLASH_ACR_WRHIGHFREQ_Pos;
    return wait(&FLASH->ACR, FLASH_ACR_LATENCY_Msk, latency << FLASH_ACR_LATENCY_Pos);
}

void epg_start_clocks(void)
{
    if (!raise_voltage() || !start_hse() || !start_pll() || !slow_flash_down()) {
        return;
    }
    /* The dividers come first, so that no bus is ever too fast.  8: AHB by 2; 4: APB by 2 (RM0433, 8.7.7 to 8.7.9). */
    RCC->D1CFGR = (CORE == AHB ? 0U : 8U << RCC_D1CFGR_HPRE_Pos) | 4U << RCC_D1CFGR_D1PPRE_Pos;
    RCC->D2CFGR = 4U << RCC_D2CFGR_D2PPRE1_Pos | 4U << RCC_D2CFGR_D2PPRE2_Pos;
    RCC->D3CFGR = 4U << RCC_D3CFGR_D3PPRE_Pos;
    RCC->CFGR = (RCC->CFGR & ~(RCC_CFGR_SW_Msk | RCC_CFGR_TIMPRE_Msk)) | RCC_CFGR_SW_PLL1;
    (void)wait(&RCC->CFGR, RCC_CFGR_SWS_Msk, RCC_CFGR_SWS_PLL1);
}
