/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Why a target was disabled.
 */
#ifndef EPG_FAULT_H
#define EPG_FAULT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Index of no component: the fault belongs to the whole target. */
#define EPG_NO_COMPONENT UINT16_MAX

/** Numbers are part of the interface: new ones come last. */
typedef enum epg_fault {
    EPG_FAULT_NONE = 0,
    EPG_FAULT_NOT_FINITE,       /**< a model input, state or output was NaN or infinite */
    EPG_FAULT_MODEL_STOPPED,    /**< the model asked to stop */
    EPG_FAULT_OVERRUN,          /**< too many overruns in a row */
    EPG_FAULT_SETPOINT_TIMEOUT, /**< a setpoint with action `disable` became too old */
    EPG_FAULT_FAIL_SAFE,        /**< the fail-safe input is inactive */
    EPG_FAULT_STALL,            /**< no counts while driving: encoder dead or motor blocked */
    EPG_FAULT_RUNAWAY,          /**< counts against the drive: encoder or motor connected the wrong way round */
    EPG_FAULT_HOMING_TRAVEL,    /**< homing went farther than the axis can */
    EPG_FAULT_HOMING_TIME,      /**< homing took too long */
    EPG_FAULT_SENSOR,           /**< a sensor's peripheral has stopped */
    EPG_FAULT_WATCHDOG,         /**< the watchdog has reset the processor: one of the two sides had stopped */
    EPG_FAULT_PROCESSOR,        /**< hard fault, failed assertion, panic or stack overflow before the last reset */
    EPG_FAULT_OUTPUT            /**< the driver of an output refused a write */
} epg_fault_t;

/** Name of a fault, for messages: "none", "not finite", "overrun", ...; "unknown" for any other number. */
const char *epg_fault_name(epg_fault_t fault);

#ifdef __cplusplus
}
#endif

#endif
