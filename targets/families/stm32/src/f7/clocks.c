/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The clocks of STM32F7, decoded from the registers of RCC (RM0410, RCC, "Clocks" and "RCC registers").
 *
 * Frequencies are in Hz.  0 stands for a frequency that cannot be known, such as that of a source which is switched off.
 */
#include <string.h>

#include "../parts.h"

/** The clock at OSC_IN: on the Nucleo boards 8 MHz, from the ST-LINK. */
#ifndef EPG_STM32_CLOCK_HSE
#define EPG_STM32_CLOCK_HSE 8000000U
#endif

#define HSI 16000000U
#define LSE 32768U

/** The highest clock of the core without the over-drive (DS11532, general operating conditions). */
#define WITHOUT_OVERDRIVE 180000000U

#define FIELD(register_, name) (((register_)&name##_Msk) >> name##_Pos)

static uint32_t hse(void)
{
    return (RCC->CR & RCC_CR_HSERDY) != 0U ? EPG_STM32_CLOCK_HSE : 0U;
}

/** The clock that PLL and PLLSAI multiply by N: source / M, times `n`, divided by `divider`. */
static uint32_t multiplied(uint32_t n, uint32_t divider)
{
    const uint32_t source = (RCC->PLLCFGR & RCC_PLLCFGR_PLLSRC) != 0U ? hse() : HSI;
    const uint32_t m = FIELD(RCC->PLLCFGR, RCC_PLLCFGR_PLLM);
    return m == 0U || divider == 0U ? 0U : (uint32_t)((uint64_t)source * n / ((uint64_t)m * divider));
}

/** Output P of the main PLL, which divides by 2, 4, 6 or 8 (RM0410, RCC_PLLCFGR). */
static uint32_t pll(void)
{
    const uint32_t config = RCC->PLLCFGR;
    const bool ready = (RCC->CR & RCC_CR_PLLRDY) != 0U;
    return ready ? multiplied(FIELD(config, RCC_PLLCFGR_PLLN), 2U * (FIELD(config, RCC_PLLCFGR_PLLP) + 1U)) : 0U;
}

/** The clock of USB: output Q of the main PLL, or output P of PLLSAI (RM0410, RCC_DCKCFGR2, CK48MSEL). */
static uint32_t usb(void)
{
    const uint32_t config = RCC->PLLCFGR;
    const uint32_t sai = RCC->PLLSAICFGR;
    if ((RCC->DCKCFGR2 & RCC_DCKCFGR2_CK48MSEL) != 0U) {
        const bool ready = (RCC->CR & RCC_CR_PLLSAIRDY) != 0U;
        const uint32_t divider = 2U * (FIELD(sai, RCC_PLLSAICFGR_PLLSAIP) + 1U);
        return ready ? multiplied(FIELD(sai, RCC_PLLSAICFGR_PLLSAIN), divider) : 0U;
    }
    const bool ready = (RCC->CR & RCC_CR_PLLRDY) != 0U;
    return ready ? multiplied(FIELD(config, RCC_PLLCFGR_PLLN), FIELD(config, RCC_PLLCFGR_PLLQ)) : 0U;
}

static uint32_t sys(void)
{
    switch (RCC->CFGR & RCC_CFGR_SWS_Msk) {
    case RCC_CFGR_SWS_HSI:
        return HSI;
    case RCC_CFGR_SWS_HSE:
        return hse();
    case RCC_CFGR_SWS_PLL:
        return pll();
    default:
        return 0U;
    }
}

/** The clock of the core and of the AHB.  HPRE: below 8 not divided, then by 2, 4, 8, 16, 64, 128, 256, 512. */
static uint32_t core(void)
{
    static const uint8_t shifts[] = {1, 2, 3, 4, 6, 7, 8, 9};
    const uint32_t value = FIELD(RCC->CFGR, RCC_CFGR_HPRE);
    return value < 8U ? sys() : sys() >> shifts[value - 8U];
}

/** An APB divides by 2^shift.  PPRE1 and PPRE2: below 4 not at all, then by 2, 4, 8, 16. */
static uint32_t shift_of(bool apb2)
{
    const uint32_t value = apb2 ? FIELD(RCC->CFGR, RCC_CFGR_PPRE2) : FIELD(RCC->CFGR, RCC_CFGR_PPRE1);
    return value < 4U ? 0U : value - 3U;
}

/**
 * The clock of the timers on an APB (RM0410, RCC_DCKCFGR1, TIMPRE): that of the AHB if the APB divides by 1 or 2, with
 * TIMPRE also by 4; else twice the clock of the APB, with TIMPRE four times.
 */
static uint32_t timers(bool apb2)
{
    const uint32_t undivided = (RCC->DCKCFGR1 & RCC_DCKCFGR1_TIMPRE) != 0U ? 2U : 1U;
    const uint32_t shift = shift_of(apb2);
    return shift <= undivided ? core() : core() >> (shift - undivided);
}

/** The kernel clock of a UART by the value of its selection (RM0410, RCC_DCKCFGR2). */
static uint32_t uart(uint32_t selection, bool apb2)
{
    switch (selection & 3U) {
    case 0:
        return core() >> shift_of(apb2);
    case 1:
        return sys();
    case 2:
        return (RCC->CR & RCC_CR_HSIRDY) != 0U ? HSI : 0U;
    default:
        return (RCC->BDCR & RCC_BDCR_LSERDY) != 0U ? LSE : 0U;
    }
}

uint32_t epg_stm32_clock_hz(const char *name)
{
    static const struct {
        const char *name;
        uint8_t position; /* of the selection in DCKCFGR2 */
        bool apb2;
    } uarts[] = {
        {"usart1", RCC_DCKCFGR2_USART1SEL_Pos, true},  {"usart2", RCC_DCKCFGR2_USART2SEL_Pos, false},
        {"usart3", RCC_DCKCFGR2_USART3SEL_Pos, false}, {"uart4", RCC_DCKCFGR2_UART4SEL_Pos, false},
        {"uart5", RCC_DCKCFGR2_UART5SEL_Pos, false},   {"usart6", RCC_DCKCFGR2_USART6SEL_Pos, true},
        {"uart7", RCC_DCKCFGR2_UART7SEL_Pos, false},   {"uart8", RCC_DCKCFGR2_UART8SEL_Pos, false},
    };
    if (strcmp(name, "core") == 0) {
        return core();
    }
    if (strcmp(name, "usb") == 0) {
        return usb();
    }
    if (strcmp(name, "apb1_timers") == 0 || strcmp(name, "apb2_timers") == 0) {
        return timers(name[3] == '2');
    }
    for (size_t i = 0; i < sizeof uarts / sizeof uarts[0]; i++) {
        if (strcmp(name, uarts[i].name) == 0) {
            return uart(RCC->DCKCFGR2 >> uarts[i].position, uarts[i].apb2);
        }
    }
    return 0U;
}

const char *epg_stm32_core_limit(uint32_t *limit_hz)
{
    *limit_hz = WITHOUT_OVERDRIVE;
    if (core() <= WITHOUT_OVERDRIVE) {
        return NULL;
    }
    /* RM0410, PWR, "Entering Over-drive mode".  Reading PWR needs its clock. */
    const uint32_t before = RCC->APB1ENR;
    RCC->APB1ENR = before | RCC_APB1ENR_PWREN;
    (void)RCC->APB1ENR;
    const bool overdrive = (PWR->CSR1 & (PWR_CSR1_ODRDY | PWR_CSR1_ODSWRDY)) == (PWR_CSR1_ODRDY | PWR_CSR1_ODSWRDY);
    RCC->APB1ENR = before;
    return overdrive ? NULL : "core (above 180 MHz only with over-drive)";
}
