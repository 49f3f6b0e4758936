/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32H7 with two USB devices: OTG_FS, which ST also calls USB2, with its own transceiver at PA11 and PA12.
 *
 * Its clock is HSI48, an oscillator of the chip.  USB needs 48 MHz within 0.25 %, and HSI48 is less accurate.  The clock
 * recovery system (CRS) trims it by the frames of the host, one per millisecond (RM0433, 9).  So neither a crystal nor a
 * PLL is necessary.
 *
 * The voltage of the cable (VBUS) is not sensed.  The device connects its pull-up at the start, with or without a host.
 */
#include "hardware.h"

/** PA11 is D-, PA12 is D+; their alternate function 10 (DS12110, table 9). */
#define PIN_MINUS 11U
#define PIN_PLUS 12U
#define FUNCTION 10U

/** Kernel clock of both USB devices: 3 is HSI48 (RM0433, 8.7.21, USBSEL). */
#define HSI48 (3U << RCC_D2CCIP2R_USBSEL_Pos)

/**
 * The source of synchronization, SYNCSRC of CRS_CFGR (RM0433, 9): frames of OTG_FS.  It is 3; up to revision Y it is 0,
 * which later became a pin.
 */
#define REVISION_X 0x2000U
#define FRAMES_OLD 0U
#define FRAMES CRS_CFGR_SYNCSRC_Msk

/** Clocks of HSI48 from one frame to the next, less one (RM0433, 9: configuration). */
#define RELOAD (48000U - 1U)
/** Error that is not corrected, in clocks: half of a step of the trimming, 0.14 % of 48000 (RM0433, 9: configuration). */
#define ERROR_LIMIT 34U

/** Readings until a part must be ready: more than 0.4 ms at 480 MHz.  HSI48 takes 6 us at most (DS12110). */
#define READINGS 50000U

const IRQn_Type epg_stm32_usb_interrupt = OTG_FS_IRQn;

static bool wait(const volatile uint32_t *word, uint32_t bit)
{
    for (uint32_t i = 0; i < READINGS; i++) {
        if ((*word & bit) != 0U) {
            return true;
        }
    }
    return false;
}

/** True if other code uses the device, or the other one with a clock that is not HSI48: both have the same clock. */
static bool taken_by_others(void)
{
    const bool other_clock = (RCC->D2CCIP2R & RCC_D2CCIP2R_USBSEL_Msk) != HSI48;
    return (RCC->AHB1ENR & RCC_AHB1ENR_USB2OTGFSEN) != 0U || NVIC_GetEnableIRQ(epg_stm32_usb_interrupt) != 0U ||
           ((RCC->AHB1ENR & RCC_AHB1ENR_USB1OTGHSEN) != 0U && other_clock);
}

/** Lets CRS trim HSI48 by the frames. */
static void synchronize(void)
{
    const uint32_t source = DBGMCU->IDCODE >> DBGMCU_IDCODE_REV_ID_Pos < REVISION_X ? FRAMES_OLD : FRAMES;
    CRS->CR &= ~CRS_CR_CEN; /* CFGR cannot be written while the counter runs (RM0433, 9: CRS_CFGR) */
    CRS->CFGR = source | ERROR_LIMIT << CRS_CFGR_FELIM_Pos | RELOAD << CRS_CFGR_RELOAD_Pos;
    CRS->CR |= CRS_CR_AUTOTRIMEN | CRS_CR_CEN;
}

bool epg_stm32_usb_power(void)
{
    if (taken_by_others()) {
        return false;
    }
    const uint32_t before = epg_stm32_enter();
    PWR->CR3 |= PWR_CR3_USB33DEN; /* detects the supply of the transceiver (RM0433, 6: USB33DEN of PWR_CR3) */
    RCC->CR |= RCC_CR_HSI48ON;
    RCC->APB1HENR |= RCC_APB1HENR_CRSEN;
    (void)RCC->APB1HENR;
    RCC->D2CCIP2R |= HSI48;
    epg_stm32_leave(before);
    if (!wait(&PWR->CR3, PWR_CR3_USB33RDY) || !wait(&RCC->CR, RCC_CR_HSI48RDY)) {
        return false;
    }
    synchronize();
    epg_stm32_connect_function(PIN_MINUS, FUNCTION, EPG_PULL_NONE);
    epg_stm32_connect_function(PIN_PLUS, FUNCTION, EPG_PULL_NONE);
    const uint32_t now = epg_stm32_enter();
    RCC->AHB1ENR |= RCC_AHB1ENR_USB2OTGFSEN;
    (void)RCC->AHB1ENR;
    RCC->AHB1RSTR |= RCC_AHB1RSTR_USB2OTGFSRST;
    RCC->AHB1RSTR &= ~RCC_AHB1RSTR_USB2OTGFSRST;
    epg_stm32_leave(now);
    return true;
}
