/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The clocks of STM32H7, decoded from the registers of RCC (RM0433, 8.5 and 8.7).
 *
 * Frequencies are in Hz.  0 stands for a frequency that cannot be known, such as that of a source which is switched off.
 */
#include <string.h>

#include "../parts.h"

/** The clock at OSC_IN: on the Nucleo boards 8 MHz, from the ST-LINK. */
#ifndef EPG_STM32_CLOCK_HSE
#define EPG_STM32_CLOCK_HSE 8000000U
#endif

#define HSI 64000000U
#define CSI 4000000U
#define LSE 32768U

/** DBGMCU_IDC, bits 31 to 16: revisions before V (0x2003) permit 400 MHz (DS12110, general operating conditions). */
#define REVISION_V 0x2003U

#define FIELD(register_, name) (((register_)&name##_Msk) >> name##_Pos)

static uint32_t hsi(void)
{
    return HSI >> FIELD(RCC->CR, RCC_CR_HSIDIV);
}

static uint32_t hse(void)
{
    return (RCC->CR & RCC_CR_HSERDY) != 0U ? EPG_STM32_CLOCK_HSE : 0U;
}

typedef enum output { OUTPUT_P, OUTPUT_Q, OUTPUT_R } output_t;

/** The frequency of an output of PLL `number`, 1 ... 3 (RM0433, 8.5.5 and 8.7.11 to 8.7.17). */
static uint32_t pll(uint32_t number, output_t output)
{
    /* The fields of PLL1, PLL2 and PLL3 have the same places in registers that follow each other. */
    const uint32_t index = number - 1U;
    const volatile uint32_t *divider = &RCC->PLL1DIVR + 2U * index;
    const volatile uint32_t *fraction = &RCC->PLL1FRACR + 2U * index;
    const uint32_t config = RCC->PLLCFGR;
    const uint32_t source = FIELD(RCC->PLLCKSELR, RCC_PLLCKSELR_PLLSRC);
    const uint32_t inputs[] = {hsi(), CSI, hse(), 0U};
    const uint32_t m = RCC->PLLCKSELR >> (RCC_PLLCKSELR_DIVM1_Pos + 8U * index) & 0x3FU;
    const bool ready = (RCC->CR & RCC_CR_PLL1RDY << (2U * index)) != 0U;
    const bool enabled = (config & RCC_PLLCFGR_DIVP1EN << (3U * index + (uint32_t)output)) != 0U;
    if (m == 0U || !ready || !enabled) {
        return 0U;
    }
    const bool fractional = (config & RCC_PLLCFGR_PLL1FRACEN << (4U * index)) != 0U;
    const uint32_t n = FIELD(*divider, RCC_PLL1DIVR_N1) + 1U;
    const uint32_t frac = fractional ? FIELD(*fraction, RCC_PLL1FRACR_FRACN1) : 0U;
    static const uint8_t places[] = {RCC_PLL1DIVR_P1_Pos, RCC_PLL1DIVR_Q1_Pos, RCC_PLL1DIVR_R1_Pos};
    const uint32_t post = (*divider >> places[output] & 0x7FU) + 1U;
    /* VCO = input / m * (n + frac / 2^13) */
    const uint64_t scaled = (uint64_t)inputs[source] * ((uint64_t)n << 13 | frac);
    return (uint32_t)(scaled / ((uint64_t)m * post) >> 13);
}

static uint32_t sys(void)
{
    switch (RCC->CFGR & RCC_CFGR_SWS_Msk) {
    case RCC_CFGR_SWS_HSI:
        return hsi();
    case RCC_CFGR_SWS_CSI:
        return CSI;
    case RCC_CFGR_SWS_HSE:
        return hse();
    default:
        return pll(1U, OUTPUT_P);
    }
}

/** Divides by the value of D1CPRE or HPRE (RM0433, 8.7.7): below 8 not at all, then by 2, 4, 8, 16, 64, 128, 256, 512. */
static uint32_t divide_9(uint32_t clock, uint32_t value)
{
    static const uint8_t shifts[] = {1, 2, 3, 4, 6, 7, 8, 9};
    return value < 8U ? clock : clock >> shifts[value - 8U];
}

/** Divides by the value of a prescaler of an APB (RM0433, 8.7.8): below 4 not at all, then by 2, 4, 8, 16. */
static uint32_t shift_of_apb(uint32_t value)
{
    return value < 4U ? 0U : value - 3U;
}

static uint32_t core(void)
{
    return divide_9(sys(), FIELD(RCC->D1CFGR, RCC_D1CFGR_D1CPRE));
}

static uint32_t ahb(void)
{
    return divide_9(core(), FIELD(RCC->D1CFGR, RCC_D1CFGR_HPRE));
}

/**
 * The clock of the timers on an APB that divides the clock of the AHB by 2^shift: RM0433, 8.5.6, table "Ratio between
 * clock timer and pclk".
 */
static uint32_t timers(uint32_t shift)
{
    const uint32_t undivided = (RCC->CFGR & RCC_CFGR_TIMPRE) != 0U ? 2U : 1U;
    return shift <= undivided ? ahb() : ahb() >> (shift - undivided);
}

static uint32_t apb1_shift(void)
{
    return shift_of_apb(FIELD(RCC->D2CFGR, RCC_D2CFGR_D2PPRE1));
}

static uint32_t apb2_shift(void)
{
    return shift_of_apb(FIELD(RCC->D2CFGR, RCC_D2CFGR_D2PPRE2));
}

static uint32_t apb1_timers(void)
{
    return timers(apb1_shift());
}

static uint32_t apb2_timers(void)
{
    return timers(apb2_shift());
}

/** The kernel clock of UARTs by the value of their selection (RM0433, 8.7.21); `apb` is selected after a reset. */
static uint32_t uarts(uint32_t selection, uint32_t apb)
{
    switch (selection) {
    case 0:
        return apb;
    case 1:
        return pll(2U, OUTPUT_Q);
    case 2:
        return pll(3U, OUTPUT_Q);
    case 3:
        return (RCC->CR & RCC_CR_HSIRDY) != 0U ? hsi() : 0U;
    case 4:
        return (RCC->CR & RCC_CR_CSIRDY) != 0U ? CSI : 0U;
    case 5:
        return (RCC->BDCR & RCC_BDCR_LSERDY) != 0U ? LSE : 0U;
    default:
        return 0U;
    }
}

static uint32_t uart1_6(void)
{
    return uarts(FIELD(RCC->D2CCIP2R, RCC_D2CCIP2R_USART16SEL), ahb() >> apb2_shift());
}

static uint32_t uart2_8(void)
{
    return uarts(FIELD(RCC->D2CCIP2R, RCC_D2CCIP2R_USART28SEL), ahb() >> apb1_shift());
}

uint32_t epg_stm32_clock_hz(const char *name)
{
    static const struct {
        const char *name;
        uint32_t (*frequency)(void);
    } clocks[] = {
        {"core", core},       {"apb1_timers", apb1_timers}, {"apb2_timers", apb2_timers},
        {"uart1_6", uart1_6}, {"uart2_8", uart2_8},
    };
    for (size_t i = 0; i < sizeof clocks / sizeof clocks[0]; i++) {
        if (strcmp(name, clocks[i].name) == 0) {
            return clocks[i].frequency();
        }
    }
    return 0U;
}

const char *epg_stm32_core_limit(uint32_t *limit_hz)
{
    *limit_hz = 400000000U;
    if (core() <= 400000000U) {
        return NULL;
    }
    if (DBGMCU->IDCODE >> DBGMCU_IDCODE_REV_ID_Pos < REVISION_V) {
        return "core (silicon before revision V: 400 MHz at most)";
    }
    /* RM0433, 6.6.2: VOS0 is VOS1 with the overdrive of SYSCFG.  Reading SYSCFG needs its clock. */
    const uint32_t before = RCC->APB4ENR;
    RCC->APB4ENR = before | RCC_APB4ENR_SYSCFGEN;
    (void)RCC->APB4ENR;
    const bool overdrive = (SYSCFG->PWRCR & SYSCFG_PWRCR_ODEN) != 0U;
    RCC->APB4ENR = before;
    const bool scale_1 = (PWR->D3CR & PWR_D3CR_VOS_Msk) == PWR_D3CR_VOS_Msk;
    return overdrive && scale_1 ? NULL : "core (above 400 MHz only with VOS0)";
}
