/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What differs between the series of STM32 for the USB device: each has a file of its name here.
 */
#ifndef EPG_STM32_USB_HARDWARE_H
#define EPG_STM32_USB_HARDWARE_H

#include "../src/parts.h"

/** The interrupt of the USB device. */
extern const IRQn_Type epg_stm32_usb_interrupt;

/**
 * Switches supply and clock of the USB device on, and connects its pins.  The device is then as after a reset.  Returns
 * false if other code uses it, or if supply or clock do not become ready.
 */
bool epg_stm32_usb_power(void);

#endif
