/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the parts of the USB device ask of each other.
 */
#ifndef EPG_ZEPHYR_USB_H
#define EPG_ZEPHYR_USB_H

#include <stdbool.h>

#ifdef CONFIG_EPG_USB_DEVICE
/** Makes the USB device of all classes in this image, once; false when that is impossible. */
bool epg_zephyr_usb_device_start(void);
#else
/* The application makes it. */
static inline bool epg_zephyr_usb_device_start(void)
{
    return true;
}
#endif

#endif
