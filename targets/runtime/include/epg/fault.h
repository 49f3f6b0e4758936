/**
 * @file
 * Why a target was disabled.
 */
#ifndef EPG_FAULT_H
#define EPG_FAULT_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum epg_fault {
    EPG_FAULT_NONE = 0,
    EPG_FAULT_NOT_FINITE,       /**< a model input, state or output was NaN or infinite */
    EPG_FAULT_MODEL_STOPPED,    /**< the model asked to stop */
    EPG_FAULT_OVERRUN,          /**< too many overruns in a row */
    EPG_FAULT_SETPOINT_TIMEOUT, /**< a setpoint with action `disable` became too old */
    EPG_FAULT_FAIL_SAFE         /**< the fail-safe input is inactive */
} epg_fault_t;

/** Name of a fault, for messages: "none", "not finite", "overrun", ...; "unknown" for any other number. */
const char *epg_fault_name(epg_fault_t fault);

#ifdef __cplusplus
}
#endif

#endif
