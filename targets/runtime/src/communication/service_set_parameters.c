/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services that set parameters.
 */
#include "epg/finite.h"
#include "parameter_request.h"

/** The reasons for which a value is refused. */
typedef enum refusal { ACCEPTED, UNKNOWN, WRONG_TYPE, NOT_FINITE, OUT_OF_RANGE } refusal_t;

static refusal_t judge(const epg_node_t *node, const epg_parameter_entry_t *entry)
{
    if (entry->index == SIZE_MAX) {
        return UNKNOWN;
    }
    if (entry->type != EPG_PARAMETER_TYPE_DOUBLE && entry->type != EPG_PARAMETER_TYPE_INTEGER) {
        return WRONG_TYPE;
    }
    if (!epg_is_finite(entry->value)) {
        return NOT_FINITE;
    }
    return epg_parameters_can_be(epg_parameters_of(node), entry->index, entry->value) ? ACCEPTED : OUT_OF_RANGE;
}

/** Returns true if the values of the request are accepted: all of them, or at least one. */
static bool accepted(epg_node_t *node, bool all)
{
    const size_t count = node->target->service_state->entries;
    bool found = all;
    for (size_t i = 0; i < count && found == all; i++) {
        const epg_parameter_entry_t entry = epg_parameter_entry_read(node, i, true);
        found = judge(node, &entry) == ACCEPTED;
    }
    return found && count > 0;
}

/** Requests all changes of the request that are accepted. */
static void stage(epg_node_t *node)
{
    epg_parameters_t *parameters = epg_parameters_of(node);
    for (size_t i = 0; i < node->target->service_state->entries; i++) {
        const epg_parameter_entry_t entry = epg_parameter_entry_read(node, i, true);
        if (judge(node, &entry) == ACCEPTED) {
            epg_parameters_prepare(parameters, entry.index, entry.value);
        }
    }
    epg_parameters_request(parameters);
}

static bool take_values(epg_node_t *node, epg_cdr_reader_t *request)
{
    node->target->service_state->staged = false;
    return epg_parameter_entries_check(node, request, true);
}

/**
 * Requests the changes as soon as those of another request, such as the console's, have been made.  Then waits for the
 * control cycle that makes them.
 */
static bool values_ready(epg_node_t *node, bool late, bool all)
{
    epg_service_state_t *state = node->target->service_state;
    epg_parameters_t *parameters = epg_parameters_of(node);
    state->success = true;
    if (!state->staged && epg_parameters_idle(parameters)) {
        state->staged = true;
        if (!accepted(node, all)) {
            return true;
        }
        stage(node);
    }
    if (!state->staged || !epg_parameters_idle(parameters)) {
        state->success = false;
        return late;
    }
    return true;
}

static bool some_ready(epg_node_t *node, bool late)
{
    return values_ready(node, late, false);
}

static bool all_ready(epg_node_t *node, bool late)
{
    return values_ready(node, late, true);
}

/** Returns the name of a type in rclcpp's messages. */
static const char *type_name(uint8_t type)
{
    static const char *const names[EPG_PARAMETER_TYPES] = {
        "not set",    "bool",       "integer",       "double",       "string",
        "byte_array", "bool_array", "integer_array", "double_array", "string_array",
    };
    return type < EPG_PARAMETER_TYPES ? names[type] : "unknown";
}

/** Writes a rcl_interfaces/msg/SetParametersResult.  The reasons are those of rclcpp. */
static void write_result(const epg_node_t *node, epg_reply_t *reply, const epg_parameter_entry_t *entry)
{
    const refusal_t refusal = judge(node, entry);
    const bool success = refusal == ACCEPTED && node->target->service_state->success;
    epg_reply_u8(reply, success ? 1 : 0);
    switch (refusal) {
    case ACCEPTED:
        epg_reply_string(reply, success ? "" : "the control loop does not run");
        return;
    case UNKNOWN:
        epg_reply_pieces(reply, "parameter '", entry->name, "' cannot be set because it was not declared", "", "");
        return;
    case WRONG_TYPE:
        epg_reply_pieces(reply, "Wrong parameter type, parameter {", entry->name,
                         "} is of type {double}, setting it to {", type_name(entry->type), "} is not allowed.");
        return;
    case NOT_FINITE:
        epg_reply_pieces(reply, "Parameter {", entry->name, "} must be a finite number.", "", "");
        return;
    case OUT_OF_RANGE:
        epg_reply_pieces(reply, "Parameter {", entry->name, "} doesn't comply with floating point range.", "", "");
        return;
    }
}

static bool write_results(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    const size_t count = node->target->service_state->entries;
    if (part == 0) {
        epg_reply_u32(reply, (uint32_t)count);
    } else if (part <= count) {
        const epg_parameter_entry_t entry = epg_parameter_entry_read(node, part - 1, true);
        write_result(node, reply, &entry);
    }
    return part <= count;
}

/** Writes the result of the first value that is refused, or of the last one if none is. */
static bool write_one_result(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    const size_t count = node->target->service_state->entries;
    if (part > 0) {
        return false;
    }
    if (count == 0) {
        epg_reply_u8(reply, 1);
        epg_reply_string(reply, "");
        return true;
    }
    epg_parameter_entry_t entry = epg_parameter_entry_read(node, 0, true);
    for (size_t i = 1; i < count && judge(node, &entry) == ACCEPTED; i++) {
        entry = epg_parameter_entry_read(node, i, true);
    }
    write_result(node, reply, &entry);
    return true;
}

const epg_service_kind_t epg_service_set_parameters = {
    .request = {.type = "rcl_interfaces::srv::dds_::SetParameters_Request_",
                .hash = EPG_TYPE_HASH("RIHS01_130d46386b7e84ea9ecf60608a4d83cbe5e5cb7c6cc5b712b7a4e3a6c254e932")},
    .reply = {.type = "rcl_interfaces::srv::dds_::SetParameters_Response_",
              .hash = EPG_TYPE_HASH("RIHS01_7a0e8140a0b8d98308fa81a5403a766e610af29a239caf54b7553227906fc266")},
    .take = take_values,
    .ready = some_ready,
    .write = write_results,
};

const epg_service_kind_t epg_service_set_parameters_atomically = {
    .request = {.type = "rcl_interfaces::srv::dds_::SetParametersAtomically_Request_",
                .hash = EPG_TYPE_HASH("RIHS01_db0bd950ed5ed867a0e90b225e44dea382d762c0762ff3e0ee842190042a59e5")},
    .reply = {.type = "rcl_interfaces::srv::dds_::SetParametersAtomically_Response_",
              .hash = EPG_TYPE_HASH("RIHS01_31b1a38c5b0b9d893ee24da45f69638f4561c78461d82d52750f429b534502b8")},
    .take = take_values,
    .ready = all_ready,
    .write = write_one_result,
};
