/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The transport `usb`: a USB device with one or two serial ports (CDC ACM), made with TinyUSB.
 *
 * A family adds these files and TinyUSB to an executable if its target uses USB.  It brings the functions below, and a
 * header `tusb_config.h` that defines these constants and then includes `epg/usb_config.h`:
 *
 * - `EPG_USB_PORTS`: the number of serial ports, 1 or 2
 * - `EPG_USB_LARGEST_MESSAGE`: bytes of the largest message that the target sends
 * - `EPG_USB_VENDOR_ID`, `EPG_USB_PRODUCT_ID`, `EPG_USB_MANUFACTURER`, `EPG_USB_PRODUCT`: the names of the device
 * - `EPG_USB_SERIAL`: optional: its serial number, in place of the board's
 * - `EPG_USB_RECEIVE_SIZE`, `EPG_USB_SEND_SIZE`: optional: bytes of the buffers of each port
 * - `EPG_USB_VERSION`: optional: the version of USB in the device descriptor, in place of 2.0
 * - `EPG_USB_FAMILY_INTERFACE`, `EPG_USB_FAMILY_TITLE`: optional: class, subclass and protocol of an interface without
 *   endpoints, and its text.  The family brings the driver of this interface
 * - settings of TinyUSB that its build does not have otherwise, such as `CFG_TUSB_MCU`
 */
#ifndef EPG_USB_H
#define EPG_USB_H

#include "epg/tinyusb.h"
#include "epg/transport.h"

/**
 * Numbers of the interfaces, in the order of the configuration descriptor.  A serial port consists of two interfaces.
 */
enum {
    EPG_USB_CDC,
    EPG_USB_CDC_DATA,
#if EPG_USB_PORTS == 2
    EPG_USB_SECOND_CDC,
    EPG_USB_SECOND_CDC_DATA,
#endif
#ifdef EPG_USB_FAMILY_INTERFACE
    EPG_USB_FAMILY,
#endif
    EPG_USB_INTERFACES
};

/** The purpose of each serial port, in the text descriptor of its interface.  NULL if the port was not started. */
extern const char *epg_usb_titles[EPG_USB_PORTS];

/** The transport `usb`: the first serial port. */
extern const epg_transport_t epg_usb;
/** The second serial port.  A device has it if the first port belongs to a middleware and the console uses USB, too. */
extern const epg_transport_t epg_usb_second;

/**
 * Brought by a family: starts the hardware and TinyUSB.  From then on each interrupt of the USB device calls
 * epg_mcu_service_wake(), after TinyUSB's handler.  Returns false if the hardware is in use or does not start.
 */
bool epg_usb_family_start(void);

/** Brought by a family: the serial number of the board, 31 characters at most. */
const char *epg_usb_family_serial(void);

#endif
