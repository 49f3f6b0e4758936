/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The SDK's headers of the flash, as system headers: their warnings are not reported.
 */
#ifndef EPG_PICO_FLASH_H
#define EPG_PICO_FLASH_H

#pragma GCC system_header

#include "hardware/flash.h"
#include "pico/flash.h"

#endif
