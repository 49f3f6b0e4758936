/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The headers of the FreeRTOS kernel, as system headers: the warnings that users choose apply to their own code only.
 *
 * It also checks the settings of FreeRTOSConfig.h that EPG needs, because a project may bring its own.
 */
#ifndef EPG_FREERTOS_RTOS_H
#define EPG_FREERTOS_RTOS_H

#pragma GCC system_header

#include "FreeRTOS.h"
#include "task.h"

#if !configSUPPORT_STATIC_ALLOCATION
#error "FreeRTOSConfig.h: EPG needs configSUPPORT_STATIC_ALLOCATION 1"
#endif
#if !INCLUDE_uxTaskGetStackHighWaterMark || !INCLUDE_vTaskDelay || !INCLUDE_xTaskGetSchedulerState
#error "FreeRTOSConfig.h: EPG needs INCLUDE_uxTaskGetStackHighWaterMark, _vTaskDelay and _xTaskGetSchedulerState 1"
#endif
#if !INCLUDE_xTaskGetCurrentTaskHandle && !configUSE_RECURSIVE_MUTEXES
#error "FreeRTOSConfig.h: EPG needs INCLUDE_xTaskGetCurrentTaskHandle 1"
#endif
#if defined(configNUMBER_OF_CORES) && configNUMBER_OF_CORES != 1 /* kernels before 11.0.0 always have one core */
#error "FreeRTOSConfig.h: EPG needs configNUMBER_OF_CORES 1, because the control loop runs outside the kernel"
#endif
/* Not a condition of the preprocessor: STM32CubeMX writes ((TickType_t)1000). */
_Static_assert(configTICK_RATE_HZ == 1000,
               "FreeRTOSConfig.h: EPG needs configTICK_RATE_HZ 1000, so that communication runs every millisecond");

#endif
