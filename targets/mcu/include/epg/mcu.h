/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Errors and measurements that the port layer reports to a program, on bare metal and on FreeRTOS.
 *
 * This header includes no header of an SDK, because generated code includes it.  Programs use the functions and names
 * in the header of their family of chips, for example `epg/pico.h`.
 */
#ifndef EPG_MCU_H
#define EPG_MCU_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The reason why a target did not start or stop, or why the program could not use the control side's core. */
typedef enum epg_mcu_error {
    EPG_MCU_OK = 0,
    EPG_MCU_ERROR_RUNNING,   /**< a target is running already */
    EPG_MCU_ERROR_CLOCK,     /**< a clock has another frequency than the target was generated for: epg_mcu_clock_t */
    EPG_MCU_ERROR_PLACEMENT, /**< code or tables of the control cycle are in the wrong memory: another linker script? */
    EPG_MCU_ERROR_RESOURCE,  /**< other code uses a peripheral or an interrupt that the target needs */
    EPG_MCU_ERROR_CORE,      /**< the control side's core did not answer */
    EPG_MCU_ERROR_CALLER,    /**< stop was called from a context that cannot wait */
    EPG_MCU_ERROR_CORE_TAKEN, /**< at a start: the program uses the control side's core.  Later: the program has tried
                                   to use that core while the target runs */
    EPG_MCU_ERROR_PRIORITY    /**< an enabled interrupt could delay the control cycle: epg_mcu_priority_t */
} epg_mcu_error_t;

/** The clock with which the newest start failed.  Its frequency is a key in `clocks` of the `.tcf`. */
typedef struct epg_mcu_clock {
    const char *name;     /**< in the data sheet, for example "clk_sys"; NULL if no clock was wrong */
    uint32_t expected_hz; /**< the frequency from which the generator computed the dividers */
    uint32_t found_hz;    /**< the frequency that the clock has */
} epg_mcu_clock_t;

/**
 * The enabled interrupt with which the newest start failed, or which caused the fault EPG_FAULT_PRIORITY.  Its priority
 * must be lower than that of the control cycle, which is 0; a larger number is a lower priority.
 */
typedef struct epg_mcu_priority {
    const char *name;  /**< in the header of the chip, for example "USART3"; NULL if no priority was wrong */
    int32_t interrupt; /**< its number there; -1 is SysTick, -16 the setting PRIGROUP of all interrupts */
} epg_mcu_priority_t;

/** Measurements of the port layer.  The statistics of the control cycle are reported elsewhere (`epg/statistics.h`). */
typedef struct epg_mcu_status {
    epg_mcu_error_t error;       /**< the newest error; EPG_MCU_OK after a successful start */
    bool after_watchdog;         /**< the watchdog or a processor fault ended the run before the last reset */
    uint32_t control_stack_size; /**< bytes of the stack on which the control cycle runs */
    uint32_t control_stack_used; /**< the largest number of its bytes in use so far */
    uint32_t main_stack_size;    /**< bytes of the stack of main() and of interrupts, except the control cycle */
    uint32_t main_stack_used;    /**< the largest number of its bytes in use so far */
    uint32_t service_stack_size; /**< bytes of the communication side's stack: its interrupt or its FreeRTOS task */
    uint32_t service_stack_used; /**< the largest number of its bytes in use so far */
    uint32_t transport_lost;     /**< bytes that the middleware's transport has received and lost */
} epg_mcu_status_t;

#ifdef __cplusplus
}
#endif

#endif
