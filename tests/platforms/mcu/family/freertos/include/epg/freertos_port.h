/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The kernel's port for Cortex-M7, for a chip with four bits of priority.
 */
#ifndef EPG_FREERTOS_PORT_H
#define EPG_FREERTOS_PORT_H

#define configCPU_CLOCK_HZ 400000000
#define configPRIO_BITS 4
#define configKERNEL_INTERRUPT_PRIORITY 0xF0
#define configMAX_SYSCALL_INTERRUPT_PRIORITY 0x50

#endif
