/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the parts of the USB device ask of each other.
 */
#ifndef EPG_PICO_USB_H
#define EPG_PICO_USB_H

#include "epg_pico_target.h"
#include "usb_sdk.h"

/** Interfaces, in the order of the configuration descriptor.  A serial port has two. */
enum {
    EPG_USB_CDC,
    EPG_USB_CDC_DATA,
#if EPG_PICO_USB_PORTS == 2
    EPG_USB_SECOND_CDC,
    EPG_USB_SECOND_CDC_DATA,
#endif
    EPG_USB_RESET,
    EPG_USB_INTERFACES
};

/** What the serial ports are for, as their interfaces' text descriptors say; NULL: not started. */
extern const char *epg_pico_usb_titles[EPG_PICO_USB_PORTS];

/** The vendor request that fetches the Microsoft OS 2.0 descriptors. */
#define EPG_USB_MICROSOFT_REQUEST 1

/** Driver of the interface by which picotool reboots the board. */
extern const usbd_class_driver_t epg_pico_usb_reset_driver;

#endif
