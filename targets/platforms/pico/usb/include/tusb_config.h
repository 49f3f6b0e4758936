/**
 * @file
 * TinyUSB as EPG uses it: one device with one serial port.
 */
#ifndef EPG_PICO_TUSB_CONFIG_H
#define EPG_PICO_TUSB_CONFIG_H

#define CFG_TUSB_RHPORT0_MODE OPT_MODE_DEVICE

#define CFG_TUD_CDC 1
/* Bytes.  What a middleware sends in one turn has to fit, as it does not wait. */
#define CFG_TUD_CDC_RX_BUFSIZE 512
#define CFG_TUD_CDC_TX_BUFSIZE 1024
#define CFG_TUD_CDC_EP_BUFSIZE 64

/* The interface for picotool has a driver of its own: reset.c. */
#define CFG_TUD_VENDOR 0

#endif
