/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Configuration of TinyUSB for all families: a device with one serial port, or with two if the console has its own
 * port.  The `tusb_config.h` of a family includes it at the end.
 */
#ifndef EPG_USB_CONFIG_H
#define EPG_USB_CONFIG_H

#if EPG_USB_PORTS != 1 && EPG_USB_PORTS != 2
#error "EPG_USB_PORTS must be 1 or 2"
#endif

/** Bytes that a frame adds to a message. */
#define EPG_USB_FRAME 32
/** Bytes of the largest frame: each byte may need an escape byte before it. */
#define EPG_USB_LARGEST_FRAME (2 * (EPG_USB_LARGEST_MESSAGE + EPG_USB_FRAME))

/*
 * Bytes of each port's buffers.  While the buffer for reception is full, the host waits, so nothing is lost.  For sending,
 * a middleware never waits for room, so the largest frame must fit.
 */
#ifndef EPG_USB_RECEIVE_SIZE
#define EPG_USB_RECEIVE_SIZE 256
#endif
#ifndef EPG_USB_SEND_SIZE
#if EPG_USB_LARGEST_FRAME > 1024
#define EPG_USB_SEND_SIZE EPG_USB_LARGEST_FRAME
#else
#define EPG_USB_SEND_SIZE 1024
#endif
#endif
#if EPG_USB_SEND_SIZE < EPG_USB_LARGEST_FRAME
#error "the send buffer of USB is too small: the target's largest message does not fit"
#endif
#if EPG_USB_SEND_SIZE > 32768
#error "a message of the target is too large for USB's buffers: the send buffer is at most 32768 bytes"
#endif

#define CFG_TUSB_RHPORT0_MODE OPT_MODE_DEVICE
#define CFG_TUD_CDC EPG_USB_PORTS
#define CFG_TUD_CDC_RX_BUFSIZE EPG_USB_RECEIVE_SIZE
#define CFG_TUD_CDC_TX_BUFSIZE EPG_USB_SEND_SIZE
#define CFG_TUD_CDC_EP_BUFSIZE 64
/* TinyUSB's driver of vendor interfaces is not needed. */
#define CFG_TUD_VENDOR 0

#endif
