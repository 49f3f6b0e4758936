/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The kernel's ports for Cortex-M4F and M7.
 */
#ifndef EPG_FREERTOS_PORT_H
#define EPG_FREERTOS_PORT_H

#define configCPU_CLOCK_HZ 25000000U
#define configKERNEL_INTERRUPT_PRIORITY 0xF0
#define configMAX_SYSCALL_INTERRUPT_PRIORITY 0x50

#endif
