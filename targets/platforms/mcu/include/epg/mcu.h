/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the port layer of a microcontroller tells the program, on bare metal and on FreeRTOS.
 *
 * Free of any SDK, as generated code is.  The header of a family of chips (`epg/pico.h`) has the functions and the names
 * that programs use.
 */
#ifndef EPG_MCU_H
#define EPG_MCU_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Why a target did not start or did not stop, or why the program did not get the core that controls. */
typedef enum epg_mcu_error {
    EPG_MCU_OK = 0,
    EPG_MCU_ERROR_RUNNING,   /**< it runs already */
    EPG_MCU_ERROR_CLOCK,     /**< a clock is not what the generator computed all dividers for */
    EPG_MCU_ERROR_PLACEMENT, /**< code or tables of the control cycle lie in the wrong memory: another linker script? */
    EPG_MCU_ERROR_RESOURCE,  /**< a peripheral or an interrupt is taken by somebody else */
    EPG_MCU_ERROR_CORE,      /**< the core that controls did not answer */
    EPG_MCU_ERROR_CALLER,    /**< a stop was called where it cannot wait */
    EPG_MCU_ERROR_CORE_TAKEN /**< start: the program uses the core that controls; later: it has asked for it, in vain */
} epg_mcu_error_t;

/** What the port layer counts besides the statistics of the control cycle. */
typedef struct epg_mcu_status {
    epg_mcu_error_t error;       /**< the newest one; EPG_MCU_OK after a start */
    bool after_watchdog;         /**< the watchdog ended the run before this one */
    uint32_t control_stack_size; /**< bytes of the stack on which the control cycle runs, */
    uint32_t control_stack_used; /**< and how many of them have ever been used */
    uint32_t main_stack_size;    /**< of the stack that main() and interrupts use beside the control cycle */
    uint32_t main_stack_used;
    uint32_t service_stack_size; /**< of communication: of its interrupt on bare metal, of its task on FreeRTOS */
    uint32_t service_stack_used;
    uint32_t transport_lost; /**< bytes that the middleware's transport has received and lost */
} epg_mcu_status_t;

#ifdef __cplusplus
}
#endif

#endif
