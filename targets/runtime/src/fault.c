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
    }
    return "unknown";
}
