/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The headers of the FreeRTOS kernel, as system headers: the warnings that users choose apply to their own code only.
 *
 * It also checks the settings of FreeRTOSConfig.h that EPG needs, where CMake has not found that file.
 */
#ifndef EPG_FREERTOS_H
#define EPG_FREERTOS_H

#pragma GCC system_header

#include "FreeRTOS.h"
#include "task.h"

#define EPG_SETTING(line) _Static_assert(0, "EPG needs in FreeRTOSConfig.h: " line);
#include "epg/freertos_settings.h"
#undef EPG_SETTING
/* Not a condition of the preprocessor: STM32CubeMX writes ((TickType_t)1000). */
_Static_assert(
    configTICK_RATE_HZ == 1000,
    "EPG needs in FreeRTOSConfig.h: #define configTICK_RATE_HZ 1000 /* communication runs every millisecond */");

#endif
