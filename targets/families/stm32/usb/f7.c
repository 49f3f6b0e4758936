/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * STM32F7: OTG_FS, with its own transceiver at PA11 and PA12.
 *
 * Its clock must be 48 MHz: output Q of the main PLL, or PLLSAI, as the program has chosen (RM0410, RCC_DCKCFGR2).
 * EPG's start-up code makes 48 MHz with HSE and a core of 216 MHz.
 *
 * The voltage of the cable (VBUS) is not sensed.  The device connects its pull-up at the start, with or without a host.
 */
#include "hardware.h"

/** PA11 is D-, PA12 is D+; their alternate function 10 (DS11532, table of alternate functions). */
#define PIN_MINUS 11U
#define PIN_PLUS 12U
#define FUNCTION 10U

#define USB_HZ 48000000U

const IRQn_Type epg_stm32_usb_interrupt = OTG_FS_IRQn;

bool epg_stm32_usb_power(void)
{
    if ((RCC->AHB2ENR & RCC_AHB2ENR_OTGFSEN) != 0U || NVIC_GetEnableIRQ(epg_stm32_usb_interrupt) != 0U ||
        epg_stm32_clock_hz("usb") != USB_HZ) {
        return false;
    }
    epg_stm32_connect_function(PIN_MINUS, FUNCTION, EPG_PULL_NONE);
    epg_stm32_connect_function(PIN_PLUS, FUNCTION, EPG_PULL_NONE);
    const uint32_t before = epg_stm32_enter();
    RCC->AHB2ENR |= RCC_AHB2ENR_OTGFSEN;
    (void)RCC->AHB2ENR;
    RCC->AHB2RSTR |= RCC_AHB2RSTR_OTGFSRST;
    RCC->AHB2RSTR &= ~RCC_AHB2RSTR_OTGFSRST;
    epg_stm32_leave(before);
    return true;
}
