/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Settings of the FreeRTOS kernel's ports for Cortex-M7 and M4F; included by EPG's FreeRTOSConfig.h.
 */
#ifndef EPG_FREERTOS_PORT_H
#define EPG_FREERTOS_PORT_H

#ifndef __ASSEMBLER__
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif
uint32_t epg_stm32_clock_hz(const char *name);
#ifdef __cplusplus
}
#endif
#endif

/** The clock of the kernel's tick, read from registers. */
#define configCPU_CLOCK_HZ (epg_stm32_clock_hz("core"))

/*
 * STM32 have 4 bits of priority, the upper ones.  The kernel runs at the lowest priority, 15.  Interrupts of priority 5 to
 * 15 may call its functions, as in projects of STM32CubeMX; it never masks those of priority 0 to 4.
 */
#define configPRIO_BITS 4
#define configKERNEL_INTERRUPT_PRIORITY 0xF0
#define configMAX_SYSCALL_INTERRUPT_PRIORITY 0x50

#endif
