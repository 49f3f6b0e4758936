/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Names of faults, of the setpoints that explain them, and of the origins of stops.
 */
#include "epg/fault.h"

#include <string.h>

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

const char *epg_stop_source_name(epg_stop_source_t source)
{
    static const char *const names[EPG_STOP_SOURCES] = {
        [EPG_STOP_START] = "start",      [EPG_STOP_LINE] = "line",         [EPG_STOP_FRAME] = "program",
        [EPG_STOP_OTHER] = "other",      [EPG_STOP_TOPIC] = "topic",       [EPG_STOP_SERVICE] = "service",
        [EPG_STOP_PROGRAM] = "firmware", [EPG_STOP_SCENARIO] = "scenario", [EPG_STOP_FAULT] = "fault",
    };
    return source < EPG_STOP_SOURCES ? names[source] : "unknown";
}

const char *epg_target_setpoint(const epg_target_t *target, size_t index)
{
    for (size_t i = 0; i < target->subscription_count; i++) {
        const epg_topic_t *topic = &target->subscriptions[i];
        if (topic->role == EPG_TOPIC_VALUES && index >= topic->index && index - topic->index < topic->count) {
            return epg_topic_value_name(topic, index - topic->index);
        }
    }
    return "";
}

const char *epg_target_stalling_setpoint(const epg_target_t *target, const epg_status_t *status)
{
    const epg_application_t *application = target->application;
    if (strcmp(epg_target_fault(target, status->fault), "stall") != 0) {
        return "";
    }
    for (size_t i = 0; i < application->setpoint_count; i++) {
        const epg_setpoint_t *setpoint = &application->setpoints[i];
        const epg_setpoint_sample_t *newest = &application->received[i];
        const bool guarded = setpoint->guard == status->fault_component || setpoint->guard == EPG_NO_COMPONENT;
        if (guarded && newest->count > 0 && epg_setpoint_is_limited(setpoint) &&
            (newest->value <= setpoint->minimum || newest->value >= setpoint->maximum)) {
            return epg_target_setpoint(target, i);
        }
    }
    return "";
}
