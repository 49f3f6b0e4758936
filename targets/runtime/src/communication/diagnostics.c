/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The status of a target as a diagnostic_msgs/msg/DiagnosticArray of ROS 2 Jazzy.
 *
 * Layout: a header (stamp, frame_id), then a sequence of one DiagnosticStatus.  It consists of level, name, message,
 * hardware_id, and a sequence of pairs of texts.
 */
#include "epg/diagnostics.h"

#include <string.h>

#include "epg/cdr.h"
#include "epg/decimal.h"
#include "epg/port.h"

enum { LEVEL_OK, LEVEL_WARN, LEVEL_ERROR };

/** How long a warning stays after its counter has grown: several periods of the diagnostics. */
static const uint64_t WARNING_NS = 5000000000;

enum {
    LONGEST_MESSAGE = 112, /* room for all warnings */
    MS = 1000000           /* ns */
};

enum { LONGEST_NAME = 63 }; /* bytes of the name of a setpoint */

static void write_pair(epg_cdr_writer_t *writer, const char *key, const char *value)
{
    epg_cdr_write_string(writer, key);
    epg_cdr_write_string(writer, value);
}

/** Writes the name of the setpoint that was refused last, or its beginning if it is long. */
static void write_refused(epg_cdr_writer_t *writer, const epg_target_t *target)
{
    const uint32_t refused = target->control->refused;
    char name[LONGEST_NAME + 1] = "";
    if (refused != 0) {
        const char *setpoint = epg_target_setpoint(target, refused - 1U);
        const size_t length = strlen(setpoint);
        memcpy(name, setpoint, length < LONGEST_NAME ? length : LONGEST_NAME);
    }
    write_pair(writer, "setpoint_refused", name);
}

/** Writes who has stopped the target last, and how long ago; no time if nothing has stopped it since the start. */
static void write_stop(epg_cdr_writer_t *writer, const epg_status_t *status)
{
    char text[EPG_DECIMAL_SIZE + 1] = "";
    if ((uint32_t)status->stop_number != 0U) {
        text[epg_decimal_write_integer(text, (int64_t)((status->time_ns - status->stop_ns) / MS))] = '\0';
    }
    write_pair(writer, "stopped_by", epg_stop_source_name(status->stop_source));
    write_pair(writer, "stopped_ms_ago", text);
}

static void write_pairs(epg_cdr_writer_t *writer, const epg_node_t *node, const epg_status_t *status)
{
    const epg_statistics_t *counted = &status->statistics;
    const struct {
        const char *key;
        uint64_t value;
    } numbers[] = {
        {"cycles", counted->cycles},
        {"overruns", counted->overruns},
        {"missed", counted->missed},
        {"outputs_late", counted->outputs_late},
        {"lateness_max_ns", counted->lateness_max},
        {"computation_min_ns", counted->computation_min},
        {"computation_mean_ns", counted->cycles > 0 ? counted->computation_total / counted->cycles : 0},
        {"computation_max_ns", counted->computation_max},
        {"clamped", counted->clamped},
        {"setpoints_dropped", counted->setpoints_dropped},
        {"setpoint_timeouts", counted->setpoint_timeouts},
        {"faults", counted->faults},
        {"reconnects", counted->reconnects},
        {"unsent", node->unsent},
        {"malformed", node->malformed},
        {"stops", (uint32_t)status->stop_number},
        {"enable_ignored", node->edge.ignored},
        {"clock_uncertainty_ns", node->clock.uncertainty_ns},
        {"clock_steps", node->clock.steps},
        {"clock_step_ms", (uint64_t)(node->clock.step_ns / MS)},
    };
    const size_t count = sizeof numbers / sizeof numbers[0];
    char text[EPG_DECIMAL_SIZE + 1];
    epg_cdr_write_u32(writer, (uint32_t)count + 10U);
    write_pair(writer, "fault", epg_target_fault(node->target, status->fault));
    write_pair(writer, "component", epg_target_component(node->target, status->fault_component));
    write_stop(writer, status);
    write_pair(writer, "enable_advice", node->edge.advice != NULL ? node->edge.advice : "");
    write_pair(writer, "client_advice", node->client_advice != NULL ? node->client_advice : "");
    for (size_t i = 0; i < count; i++) {
        text[epg_decimal_write_integer(text, (int64_t)numbers[i].value)] = '\0';
        write_pair(writer, numbers[i].key, text);
    }
    write_refused(writer, node->target);
    write_pair(writer, "clock", node->clock.set ? "set" : "not set");
    write_pair(writer, "epg", node->target->version);
    write_pair(writer, "firmware", node->target->hash);
}

/** Updates the warnings.  Returns true if there is one. */
static bool update_warnings(epg_node_t *node, const epg_status_t *status)
{
    const uint32_t counts[EPG_NODE_WARNINGS] = {
        [EPG_NODE_OVERRUNS] = status->statistics.overruns,
        [EPG_NODE_TIMEOUTS] = status->statistics.setpoint_timeouts,
        [EPG_NODE_REFUSED] = status->statistics.setpoints_dropped,
        [EPG_NODE_MALFORMED] = node->malformed,
        [EPG_NODE_STEPS] = node->clock.steps,
    };
    bool any = !node->clock.set;
    for (size_t i = 0; i < EPG_NODE_WARNINGS; i++) {
        epg_node_warning_t *warning = &node->warnings[i];
        if (warning->count != counts[i]) {
            warning->count = counts[i];
            warning->until_ns = status->time_ns + WARNING_NS;
        }
        any |= warning->until_ns > status->time_ns;
    }
    return any;
}

/** Appends a text.  Returns the end of both; there must be room. */
static char *append(char *end, const char *text)
{
    const size_t length = strlen(text);
    memcpy(end, text, length + 1);
    return end + length;
}

/**
 * Writes namespace and name of the node, such as "robot_7/JIWY_node": monitors take statuses of one name for those of
 * one robot.
 */
static void write_name(epg_cdr_writer_t *writer, const epg_node_t *node)
{
    char name[EPG_NODE_SPACE_SIZE + EPG_NODE_NAME_SIZE];
    (void)epg_node_name(node, "~", false, name, sizeof name);
    epg_cdr_write_string(writer, name + 1); /* without the leading slash */
}

/** Writes the level, the name and the message, such as "enabled; setpoint timeouts; malformed messages". */
static void write_summary(epg_cdr_writer_t *writer, epg_node_t *node, const epg_status_t *status)
{
    static const char *const names[EPG_NODE_WARNINGS] = {
        [EPG_NODE_OVERRUNS] = "; overruns",         [EPG_NODE_TIMEOUTS] = "; setpoint timeouts",
        [EPG_NODE_REFUSED] = "; refused setpoints", [EPG_NODE_MALFORMED] = "; malformed messages",
        [EPG_NODE_STEPS] = "; step of the clock",
    };
    const bool warning = update_warnings(node, status) || !status->enabled;
    const bool fault = status->fault != EPG_FAULT_NONE;
    epg_cdr_write_u8(writer, fault ? LEVEL_ERROR : warning ? LEVEL_WARN : LEVEL_OK);
    write_name(writer, node);
    if (fault || !status->enabled) {
        epg_cdr_write_string(writer, fault ? epg_target_fault(node->target, status->fault) : "disabled");
        return;
    }
    char text[LONGEST_MESSAGE];
    char *end = append(text, "enabled");
    for (size_t i = 0; i < EPG_NODE_WARNINGS; i++) {
        if (node->warnings[i].until_ns > status->time_ns) {
            end = append(end, names[i]);
        }
    }
    if (!node->clock.set) {
        (void)append(end, "; clock not set");
    }
    epg_cdr_write_string(writer, text);
}

size_t epg_diagnostics_write(epg_node_t *node, epg_stamp_t stamp, void *data, size_t size)
{
    epg_cdr_writer_t writer = {.data = data, .size = size};
    epg_status_t status;
    if (!epg_control_observe(node->target->control, &status)) {
        return 0;
    }
    epg_cdr_write_i32(&writer, stamp.seconds);
    epg_cdr_write_u32(&writer, stamp.nanoseconds);
    epg_cdr_write_string(&writer, "");
    epg_cdr_write_u32(&writer, 1);
    write_summary(&writer, node, &status);
    epg_cdr_write_string(&writer, epg_port_serial());
    write_pairs(&writer, node, &status);
    return writer.failed ? 0 : writer.length;
}

const epg_message_t epg_message_diagnostic_array = {
    .type = "diagnostic_msgs::msg::dds_::DiagnosticArray_",
    .hash = EPG_TYPE_HASH("RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"),
    .write = NULL,
    .read = NULL,
    .stamped = true,
};
