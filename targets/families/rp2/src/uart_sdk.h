/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The SDK's headers of the UARTs and the DMA, as system headers: their warnings are not reported.
 */
#ifndef EPG_PICO_UART_SDK_H
#define EPG_PICO_UART_SDK_H

#pragma GCC system_header

#include "hardware/dma.h"
#include "hardware/structs/dma_debug.h"
#include "hardware/uart.h"

#endif
