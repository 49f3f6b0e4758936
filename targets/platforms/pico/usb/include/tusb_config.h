/**
 * @file
 * TinyUSB as EPG uses it: one device with one serial port, or two when the console has one of its own.
 */
#ifndef EPG_PICO_TUSB_CONFIG_H
#define EPG_PICO_TUSB_CONFIG_H

/* pico.cmake says how many serial ports the target has. */
#if EPG_PICO_USB_PORTS != 1 && EPG_PICO_USB_PORTS != 2
#error "EPG_PICO_USB_PORTS must be 1 or 2"
#endif

/* Bytes of each port.  What a middleware sends in one turn has to fit, as it does not wait. */
#ifndef EPG_PICO_USB_RECEIVE_SIZE
#define EPG_PICO_USB_RECEIVE_SIZE 512
#endif
#ifndef EPG_PICO_USB_SEND_SIZE
#define EPG_PICO_USB_SEND_SIZE 1024
#endif

#define CFG_TUSB_RHPORT0_MODE OPT_MODE_DEVICE

#define CFG_TUD_CDC EPG_PICO_USB_PORTS
#define CFG_TUD_CDC_RX_BUFSIZE EPG_PICO_USB_RECEIVE_SIZE
#define CFG_TUD_CDC_TX_BUFSIZE EPG_PICO_USB_SEND_SIZE
#define CFG_TUD_CDC_EP_BUFSIZE 64

/* The interface for picotool has a driver of its own: reset.c. */
#define CFG_TUD_VENDOR 0

#endif
