/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The interface by which picotool reboots the board.
 */
#ifndef EPG_PICO_USB_RESET_H
#define EPG_PICO_USB_RESET_H

#include "epg/usb.h"

/** Number of the interface. */
#define EPG_USB_RESET EPG_USB_FAMILY

#endif
