/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The settings of FreeRTOSConfig.h that EPG needs, because a project may bring its own: a line for each that is wrong.
 *
 * platform.cmake reads these lines with the preprocessor, where it finds the project's FreeRTOSConfig.h.  `epg/freertos.h`
 * makes them errors of the compiler.
 */
/* clang-format off */
#if !configSUPPORT_STATIC_ALLOCATION
EPG_SETTING("#define configSUPPORT_STATIC_ALLOCATION 1")
#endif
#if !INCLUDE_uxTaskGetStackHighWaterMark
EPG_SETTING("#define INCLUDE_uxTaskGetStackHighWaterMark 1")
#endif
#if !INCLUDE_vTaskDelay
EPG_SETTING("#define INCLUDE_vTaskDelay 1")
#endif
#if !INCLUDE_xTaskGetSchedulerState
EPG_SETTING("#define INCLUDE_xTaskGetSchedulerState 1")
#endif
#if !INCLUDE_xTaskGetCurrentTaskHandle && !configUSE_RECURSIVE_MUTEXES
EPG_SETTING("#define INCLUDE_xTaskGetCurrentTaskHandle 1")
#endif
#if defined(configNUMBER_OF_CORES) && configNUMBER_OF_CORES != 1 /* kernels before 11.0.0 always have one core */
EPG_SETTING("#define configNUMBER_OF_CORES 1 /* the control loop runs outside the kernel */")
#endif
