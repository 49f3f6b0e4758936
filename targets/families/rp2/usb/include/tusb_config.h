/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Configuration of TinyUSB: a device with one serial port, or with two if the console has its own port.
 */
#ifndef EPG_PICO_TUSB_CONFIG_H
#define EPG_PICO_TUSB_CONFIG_H

#include "epg_pico_target.h"

#if EPG_PICO_USB_PORTS != 1 && EPG_PICO_USB_PORTS != 2
#error "EPG_PICO_USB_PORTS must be 1 or 2"
#endif

/** Bytes that a frame adds to a message. */
#define EPG_PICO_USB_FRAME 32
/** Bytes of the largest frame: each byte may need an escape byte before it. */
#define EPG_PICO_USB_LARGEST_FRAME (2 * (EPG_PICO_LARGEST_MESSAGE + EPG_PICO_USB_FRAME))

/* Bytes of each port's buffers.  A middleware never waits for room, so the largest frame must fit. */
#ifndef EPG_PICO_USB_RECEIVE_SIZE
#define EPG_PICO_USB_RECEIVE_SIZE 512
#endif
#ifndef EPG_PICO_USB_SEND_SIZE
#if EPG_PICO_USB_LARGEST_FRAME > 1024
#define EPG_PICO_USB_SEND_SIZE EPG_PICO_USB_LARGEST_FRAME
#else
#define EPG_PICO_USB_SEND_SIZE 1024
#endif
#endif
#if EPG_PICO_USB_SEND_SIZE < EPG_PICO_USB_LARGEST_FRAME
#error "EPG_PICO_USB_SEND_SIZE: the target's largest message does not fit"
#endif
#if EPG_PICO_USB_SEND_SIZE > 32768
#error "a message of the target is too large for USB's buffers: EPG_PICO_USB_SEND_SIZE is at most 32768"
#endif

#define CFG_TUSB_RHPORT0_MODE OPT_MODE_DEVICE

#define CFG_TUD_CDC EPG_PICO_USB_PORTS
#define CFG_TUD_CDC_RX_BUFSIZE EPG_PICO_USB_RECEIVE_SIZE
#define CFG_TUD_CDC_TX_BUFSIZE EPG_PICO_USB_SEND_SIZE
#define CFG_TUD_CDC_EP_BUFSIZE 64

/* TinyUSB's driver of vendor interfaces is not needed: reset.c has a driver for picotool's interface. */
#define CFG_TUD_VENDOR 0

#endif
