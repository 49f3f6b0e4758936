/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The SDK's header of the UARTs, as a system header: its warnings are not reported.
 */
#ifndef EPG_PICO_UART_SDK_H
#define EPG_PICO_UART_SDK_H

#pragma GCC system_header

#include "hardware/uart.h"

#endif
