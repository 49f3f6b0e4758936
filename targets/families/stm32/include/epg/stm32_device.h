/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The headers of ST and Arm with the registers of the chip, as system headers: the warnings that users choose apply to
 * their own code only.
 *
 * family.cmake defines the name of the chip, such as STM32H743xx, and EPG_STM32_H7 or another series.
 */
#ifndef EPG_STM32_DEVICE_H
#define EPG_STM32_DEVICE_H

#pragma GCC system_header

#if defined(EPG_STM32_H7)
#include "stm32h7xx.h"
#elif defined(EPG_STM32_F7)
#include "stm32f7xx.h"
#define USART_ICR_NECF USART_ICR_NCF /* the name of this bit in the other series */
#else
#error "EPG does not have this series of STM32"
#endif

#endif
