/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Faults: the reasons for which a target disables itself.
 *
 * A fault is latched: the target stays disabled, with its outputs safe, until a request to enable clears the fault.  If
 * several faults happen, the first one is kept, because it is usually the cause of the others.
 */
#ifndef EPG_FAULT_H
#define EPG_FAULT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Component index of a fault that belongs to the whole target. */
#define EPG_NO_COMPONENT UINT16_MAX

/**
 * The faults that the runtime and the platforms raise.  A component kind declares its own faults in its component.yaml.
 *
 * The numbers are part of the interface, and stay.  A new fault must be added before EPG_FAULT_LARGEST.  The numbers 6
 * to 10, and those from 256 to EPG_FAULT_LARGEST, belong to component kinds.
 */
typedef enum epg_fault {
    EPG_FAULT_NONE = 0,
    EPG_FAULT_NOT_FINITE,       /**< a model input, state or output was NaN or infinite */
    EPG_FAULT_MODEL_STOPPED,    /**< the model asked to stop */
    EPG_FAULT_OVERRUN,          /**< too many overruns in a row */
    EPG_FAULT_SETPOINT_TIMEOUT, /**< a setpoint with action `disable` became too old */
    EPG_FAULT_FAIL_SAFE,        /**< the fail-safe input is inactive */
    EPG_FAULT_WATCHDOG = 11,    /**< the watchdog reset the processor, because one of the two sides had stopped */
    EPG_FAULT_PROCESSOR,        /**< a hard fault, failed assertion, panic or stack overflow caused the last reset */
    EPG_FAULT_OUTPUT,           /**< the driver of an output refused a write */
    EPG_FAULT_TICK,             /**< the timer of the control cycle has a period that is not the control period */
    EPG_FAULT_PRIORITY,         /**< another interrupt has the control cycle's priority, and could delay it */
    EPG_FAULT_OPERATOR,         /**< the program that had enabled the target on a lease does not answer any more */
    EPG_FAULT_LARGEST = 0xFFFF  /**< the largest possible number, so that the type has room for it */
} epg_fault_t;

/** A fault that a component kind declares.  epg_target_fault() (epg/target.h) gives the name of any fault. */
typedef struct epg_kind_fault {
    epg_fault_t fault;
    const char *name;
} epg_kind_fault_t;

#ifdef __cplusplus
}
#endif

#endif
