/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * RP2040 and RP2350 for EPG's FreeRTOSConfig.h.
 */
#ifndef EPG_FREERTOS_PORT_H
#define EPG_FREERTOS_PORT_H

/* Ports for RP2040 and RP2350: mutexes, semaphores and sleep_ms() of the Pico SDK work in tasks. */
#define configSUPPORT_PICO_SYNC_INTEROP 1
#define configSUPPORT_PICO_TIME_INTEROP 1

/* Port for RP2350 (Cortex-M33): all in secure state, FPU saved, kernel below the SDK's default interrupt priority. */
#define configENABLE_FPU 1
#define configENABLE_MPU 0
#define configENABLE_TRUSTZONE 0
#define configRUN_FREERTOS_SECURE_ONLY 1
#define configMAX_SYSCALL_INTERRUPT_PRIORITY 16

#endif
