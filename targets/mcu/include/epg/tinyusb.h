/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The headers of TinyUSB, as system headers: their warnings are not reported.
 */
#ifndef EPG_USB_TINYUSB_H
#define EPG_USB_TINYUSB_H

#pragma GCC system_header

#include "device/usbd_pvt.h"
#include "tusb.h"

#endif
