/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The start of the USB device.
 */
#ifndef EPG_ZEPHYR_USB_H
#define EPG_ZEPHYR_USB_H

#include <stdbool.h>

#ifdef CONFIG_EPG_USB_DEVICE
/** Starts the USB device, with all USB classes in this image.  Later calls do nothing.  Returns false if it fails. */
bool epg_zephyr_usb_device_start(void);
#else
/* The application starts the USB device. */
static inline bool epg_zephyr_usb_device_start(void)
{
    return true;
}
#endif

#endif
