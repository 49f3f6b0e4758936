/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Settings of the FreeRTOS kernel's ports for RP2040 and RP2350; included by EPG's FreeRTOSConfig.h.
 */
#ifndef EPG_FREERTOS_PORT_H
#define EPG_FREERTOS_PORT_H

/* Both ports: mutexes, semaphores and sleep_ms() of the Pico SDK work in tasks. */
#define configSUPPORT_PICO_SYNC_INTEROP 1
#define configSUPPORT_PICO_TIME_INTEROP 1

/*
 * Port for RP2350 (Cortex-M33): all code runs in the secure state, a switch of tasks saves the FPU's registers, and
 * critical sections of the kernel mask the interrupts of the SDK's default priority.
 */
#define configENABLE_FPU 1
#define configENABLE_MPU 0
#define configENABLE_TRUSTZONE 0
#define configRUN_FREERTOS_SECURE_ONLY 1
#define configMAX_SYSCALL_INTERRUPT_PRIORITY 16

#endif
