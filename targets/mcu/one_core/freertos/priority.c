/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The priority of transports on FreeRTOS: the highest at which the kernel permits calls of its functions.
 *
 * The kernel masks this priority and all lower ones by BASEPRI in its critical sections.  The tick has priority 0, which
 * BASEPRI cannot mask.
 */
#include "epg/freertos.h"
#include "epg/one_core.h"

_Static_assert(
    (configMAX_SYSCALL_INTERRUPT_PRIORITY) >> (8U - __NVIC_PRIO_BITS) > 0U,
    "FreeRTOSConfig.h: configMAX_SYSCALL_INTERRUPT_PRIORITY must be lower than priority 0, the control cycle's");

const uint32_t epg_one_core_transport_priority = (configMAX_SYSCALL_INTERRUPT_PRIORITY) >> (8U - __NVIC_PRIO_BITS);
