/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The constants and variables that the files of the USB device share.
 */
#ifndef EPG_PICO_USB_H
#define EPG_PICO_USB_H

#include "epg_pico_target.h"
#include "usb_sdk.h"

/**
 * Numbers of the interfaces, in the order of the configuration descriptor.  A serial port consists of two interfaces.
 */
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

/** The purpose of each serial port, in the text descriptor of its interface.  NULL if the port was not started. */
extern const char *epg_pico_usb_titles[EPG_PICO_USB_PORTS];

/** Number of the vendor request by which Windows reads the Microsoft OS 2.0 descriptors. */
#define EPG_USB_MICROSOFT_REQUEST 1

/** TinyUSB driver of the interface by which picotool reboots the board. */
extern const usbd_class_driver_t epg_pico_usb_reset_driver;

#endif
