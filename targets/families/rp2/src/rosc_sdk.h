/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The registers of the ring oscillator, as a system header: its warnings are not reported.
 */
#ifndef EPG_PICO_ROSC_SDK_H
#define EPG_PICO_ROSC_SDK_H

#pragma GCC system_header

#include "hardware/structs/rosc.h"

#endif
