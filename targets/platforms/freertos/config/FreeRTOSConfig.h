/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * EPG's configuration of the FreeRTOS kernel: one core, static memory, a kernel tick of 1 ms.
 *
 * The control loop does not use the kernel.  It runs on its own core, or in an interrupt with a priority above those
 * that the kernel masks.  The kernel is therefore configured for one core.
 *
 * A project can have its own CMake target FreeRTOS-Kernel with its own FreeRTOSConfig.h; this file is not used then.
 * `epg/freertos_settings.h` lists the settings that EPG needs.
 */
#ifndef EPG_FREERTOS_CONFIG_H
#define EPG_FREERTOS_CONFIG_H

/* Scheduler */
#define configNUMBER_OF_CORES 1
#define configUSE_PREEMPTION 1
#define configUSE_TIME_SLICING 1
#define configUSE_TICKLESS_IDLE 0
#define configUSE_PORT_OPTIMISED_TASK_SELECTION 0
#define configTICK_RATE_HZ 1000
#define configTICK_TYPE_WIDTH_IN_BITS TICK_TYPE_WIDTH_32_BITS
#define configMAX_PRIORITIES 8
#define configMINIMAL_STACK_SIZE 256 /* words */
#define configMAX_TASK_NAME_LEN 16
#define configIDLE_SHOULD_YIELD 1
#define configSTACK_DEPTH_TYPE uint32_t

/* Memory */
#define configSUPPORT_STATIC_ALLOCATION 1
#define configSUPPORT_DYNAMIC_ALLOCATION 0
#define configKERNEL_PROVIDED_STATIC_MEMORY 1

/* Services */
#define configUSE_TASK_NOTIFICATIONS 1
#define configTASK_NOTIFICATION_ARRAY_ENTRIES 1
#define configUSE_MUTEXES 1
#define configUSE_RECURSIVE_MUTEXES 1
#define configUSE_COUNTING_SEMAPHORES 1
#define configUSE_QUEUE_SETS 0
#define configUSE_EVENT_GROUPS 1
#define configUSE_STREAM_BUFFERS 1
#define configUSE_TIMERS 1
#define configTIMER_TASK_PRIORITY (configMAX_PRIORITIES - 1)
#define configTIMER_QUEUE_LENGTH 10
#define configTIMER_TASK_STACK_DEPTH configMINIMAL_STACK_SIZE

/* Hooks and checks */
#define configUSE_IDLE_HOOK 1
#define configUSE_TICK_HOOK 0
#define configUSE_MALLOC_FAILED_HOOK 0
#define configUSE_DAEMON_TASK_STARTUP_HOOK 0
#define configCHECK_FOR_STACK_OVERFLOW 2
#define configENABLE_BACKWARD_COMPATIBILITY 0

#ifndef __ASSEMBLER__
#ifdef __cplusplus
extern "C" {
#endif
void epg_freertos_assert_failed(const char *file, int line);
#ifdef __cplusplus
}
#endif
#define configASSERT(condition)                                                                                        \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            epg_freertos_assert_failed(__FILE__, __LINE__);                                                            \
        }                                                                                                              \
    } while (0)
#endif

/* Settings of the kernel's port for the family of chips. */
#include "epg/freertos_port.h"

#define INCLUDE_vTaskPrioritySet 1
#define INCLUDE_uxTaskPriorityGet 1
#define INCLUDE_vTaskDelete 1
#define INCLUDE_vTaskSuspend 1
#define INCLUDE_xTaskDelayUntil 1
#define INCLUDE_vTaskDelay 1
#define INCLUDE_xTaskGetSchedulerState 1
#define INCLUDE_xTaskGetCurrentTaskHandle 1
#define INCLUDE_uxTaskGetStackHighWaterMark 1
#define INCLUDE_eTaskGetState 1
#define INCLUDE_xTimerPendFunctionCall 1
#define INCLUDE_xTaskAbortDelay 1
#define INCLUDE_xTaskResumeFromISR 1

#endif
