/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The headers of the Pico SDK for USB, as system headers: their warnings are not reported.
 */
#ifndef EPG_PICO_USB_SDK_H
#define EPG_PICO_USB_SDK_H

#pragma GCC system_header

#include "pico/bootrom.h"
#include "pico/unique_id.h"
#include "pico/usb_reset_interface.h"

#if LIB_PICO_STDIO_USB
#error                                                                                                                 \
    "EPG's transport 'usb' and the SDK's stdio over USB need the same USB device: write pico_enable_stdio_usb(<executable> 0), or choose another transport in the .tcf"
#endif

#endif
