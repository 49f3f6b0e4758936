/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Configuration of TinyUSB, and of EPG's USB device (`epg/usb.h`), for RP2040 and RP2350.
 *
 * Names and numbers come from definitions of the executable or from the target configuration (`communication: {usb:
 * ...}`, in epg_pico_target.h).  By default the numbers are those of the Pico SDK's own serial port, by which picotool
 * and udev rules recognise a board that runs firmware.
 */
#ifndef EPG_PICO_TUSB_CONFIG_H
#define EPG_PICO_TUSB_CONFIG_H

#include "epg_pico_target.h"
#include "pico/usb_reset_interface.h"

#define EPG_USB_PORTS EPG_PICO_USB_PORTS
#define EPG_USB_LARGEST_MESSAGE EPG_PICO_LARGEST_MESSAGE

#if defined(EPG_PICO_USB_VENDOR_ID) != defined(EPG_PICO_USB_PRODUCT_ID)
#error "define both EPG_PICO_USB_VENDOR_ID and EPG_PICO_USB_PRODUCT_ID: a product id is valid only with its vendor id"
#endif
#ifndef EPG_PICO_USB_VENDOR_ID
#define EPG_PICO_USB_VENDOR_ID 0x2E8A /* Raspberry Pi */
#if PICO_RP2040
#define EPG_PICO_USB_PRODUCT_ID 0x000A /* Pico SDK CDC UART */
#else
#define EPG_PICO_USB_PRODUCT_ID 0x0009
#endif
#endif
#ifndef EPG_PICO_USB_MANUFACTURER
#define EPG_PICO_USB_MANUFACTURER "Raspberry Pi"
#endif
#ifndef EPG_PICO_USB_PRODUCT
#define EPG_PICO_USB_PRODUCT "Pico"
#endif
#define EPG_USB_VENDOR_ID EPG_PICO_USB_VENDOR_ID
#define EPG_USB_PRODUCT_ID EPG_PICO_USB_PRODUCT_ID
#define EPG_USB_MANUFACTURER EPG_PICO_USB_MANUFACTURER
#define EPG_USB_PRODUCT EPG_PICO_USB_PRODUCT
#ifdef EPG_PICO_USB_SERIAL
#define EPG_USB_SERIAL EPG_PICO_USB_SERIAL
#endif

#ifdef EPG_PICO_USB_RECEIVE_SIZE
#define EPG_USB_RECEIVE_SIZE EPG_PICO_USB_RECEIVE_SIZE
#endif
#ifdef EPG_PICO_USB_SEND_SIZE
#define EPG_USB_SEND_SIZE EPG_PICO_USB_SEND_SIZE
#endif

/** USB 2.1, the first version with a BOS descriptor. */
#define EPG_USB_VERSION 0x0210

/* The interface by which picotool reboots the board: reset.c. */
#define EPG_USB_FAMILY_INTERFACE TUSB_CLASS_VENDOR_SPECIFIC, RESET_INTERFACE_SUBCLASS, RESET_INTERFACE_PROTOCOL
#define EPG_USB_FAMILY_TITLE "Reset"

#include "epg/usb_config.h"

#endif
