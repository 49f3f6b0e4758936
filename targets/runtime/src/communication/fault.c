/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Names of faults.
 */
#include "epg/fault.h"

#include "epg/target.h"

const char *epg_target_fault(const epg_target_t *target, epg_fault_t fault)
{
    static const char *const names[] = {
        [EPG_FAULT_NONE] = "none",
        [EPG_FAULT_NOT_FINITE] = "not finite",
        [EPG_FAULT_MODEL_STOPPED] = "model stopped",
        [EPG_FAULT_OVERRUN] = "overrun",
        [EPG_FAULT_SETPOINT_TIMEOUT] = "setpoint timeout",
        [EPG_FAULT_FAIL_SAFE] = "fail-safe",
        [EPG_FAULT_WATCHDOG] = "watchdog",
        [EPG_FAULT_PROCESSOR] = "processor",
        [EPG_FAULT_OUTPUT] = "output",
        [EPG_FAULT_TICK] = "tick",
        [EPG_FAULT_PRIORITY] = "priority",
        [EPG_FAULT_OPERATOR] = "operator",
    };
    if ((size_t)fault < sizeof names / sizeof names[0] && names[fault] != NULL) {
        return names[fault];
    }
    for (size_t i = 0; i < target->fault_count; i++) {
        if (target->faults[i].fault == fault) {
            return target->faults[i].name;
        }
    }
    return "unknown";
}
