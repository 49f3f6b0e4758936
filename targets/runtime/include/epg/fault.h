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

/** The numbers are part of the interface.  A new fault must be added at the end. */
typedef enum epg_fault {
    EPG_FAULT_NONE = 0,
    EPG_FAULT_NOT_FINITE,       /**< a model input, state or output was NaN or infinite */
    EPG_FAULT_MODEL_STOPPED,    /**< the model asked to stop */
    EPG_FAULT_OVERRUN,          /**< too many overruns in a row */
    EPG_FAULT_SETPOINT_TIMEOUT, /**< a setpoint with action `disable` became too old */
    EPG_FAULT_FAIL_SAFE,        /**< the fail-safe input is inactive */
    EPG_FAULT_STALL,            /**< a driven motor gave no counts: the encoder is dead or the motor is blocked */
    EPG_FAULT_RUNAWAY,          /**< an axis moved against its drive: encoder or motor has its wires swapped */
    EPG_FAULT_HOMING_TRAVEL,    /**< homing went farther than the range of the axis */
    EPG_FAULT_HOMING_TIME,      /**< homing took too long */
    EPG_FAULT_SENSOR,           /**< a sensor's peripheral has stopped */
    EPG_FAULT_WATCHDOG,         /**< the watchdog reset the processor, because one of the two sides had stopped */
    EPG_FAULT_PROCESSOR,        /**< a hard fault, failed assertion, panic or stack overflow caused the last reset */
    EPG_FAULT_OUTPUT            /**< the driver of an output refused a write */
} epg_fault_t;

/** Returns the name of a fault for messages: "none", "not finite", "overrun", ...; "unknown" for any other number. */
const char *epg_fault_name(epg_fault_t fault);

#ifdef __cplusplus
}
#endif

#endif
