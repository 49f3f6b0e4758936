/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Names of faults.
 */
#include "epg/fault.h"

const char *epg_fault_name(epg_fault_t fault)
{
    switch (fault) {
    case EPG_FAULT_NONE:
        return "none";
    case EPG_FAULT_NOT_FINITE:
        return "not finite";
    case EPG_FAULT_MODEL_STOPPED:
        return "model stopped";
    case EPG_FAULT_OVERRUN:
        return "overrun";
    case EPG_FAULT_SETPOINT_TIMEOUT:
        return "setpoint timeout";
    case EPG_FAULT_FAIL_SAFE:
        return "fail-safe";
    case EPG_FAULT_STALL:
        return "stall";
    case EPG_FAULT_RUNAWAY:
        return "runaway";
    case EPG_FAULT_HOMING_TRAVEL:
        return "homing travel";
    case EPG_FAULT_HOMING_TIME:
        return "homing time";
    case EPG_FAULT_SENSOR:
        return "sensor";
    case EPG_FAULT_WATCHDOG:
        return "watchdog";
    case EPG_FAULT_PROCESSOR:
        return "processor";
    case EPG_FAULT_OUTPUT:
        return "output";
    }
    return "unknown";
}
