/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The library pico_quadrature and the SDK's headers of the PIO, as system headers: their warnings are not reported.
 */
#ifndef EPG_PICO_ENCODER_SDK_H
#define EPG_PICO_ENCODER_SDK_H

#pragma GCC system_header

#include "epg/pico_quadrature.h"

#endif
