/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services that change the state of a target: SetBool to enable or disable it, Trigger to clear a
 * fault and to store parameters.
 */
#include <string.h>

#include "epg/decimal.h"
#include "epg/parameter_services.h"
#include "epg/store.h"
#include "reply.h"

#define TRIGGER_REQUEST                                                                                                \
    {                                                                                                                  \
        .type = "std_srvs::srv::dds_::Trigger_Request_",                                                               \
        .hash = EPG_TYPE_HASH("RIHS01_d010825374ce8918e72bfd826c82603e60f45419e932ea976f807b74a863a199")               \
    }
#define TRIGGER_REPLY                                                                                                  \
    {                                                                                                                  \
        .type = "std_srvs::srv::dds_::Trigger_Response_",                                                              \
        .hash = EPG_TYPE_HASH("RIHS01_2d946c21e2fc3f1e9ca6986a8191d85fcc70097a8bb7771a053564bc47009cdf")               \
    }

/** Begins to count control cycles. */
static void begin(epg_node_t *node)
{
    epg_service_state_t *state = node->target->service_state;
    epg_status_t status;
    state->observed = epg_control_observe(node->target->control, &status);
    state->cycles = state->observed ? status.statistics.cycles : 0;
}

/** Copies the newest status.  Returns true if at least `cycles` cycles have ended since begin(). */
static bool cycled(const epg_node_t *node, epg_status_t *status, uint32_t cycles)
{
    epg_service_state_t *state = node->target->service_state;
    if (!epg_control_observe(node->target->control, status)) {
        return false;
    }
    if (!state->observed) {
        state->observed = true;
        state->cycles = status->statistics.cycles;
    }
    return status->statistics.cycles - state->cycles >= cycles;
}

/** Adds `text` to the message of the reply, as far as it fits. */
static void add(epg_service_state_t *state, const char *text)
{
    const size_t used = strlen(state->message);
    const size_t room = sizeof state->message - 1 - used;
    const size_t length = strlen(text) < room ? strlen(text) : room;
    memcpy(state->message + used, text, length);
    state->message[used + length] = '\0';
}

/** Adds the fault that is latched, if there is one. */
static void add_fault(const epg_node_t *node, const epg_status_t *status)
{
    epg_service_state_t *state = node->target->service_state;
    const char *component = epg_target_component(node->target, status->fault_component);
    if (status->fault == EPG_FAULT_NONE) {
        return;
    }
    add(state, ": fault '");
    add(state, epg_target_fault(node->target, status->fault));
    add(state, "'");
    if (component[0] != '\0') {
        add(state, " of ");
        add(state, component);
    }
}

/** Sets the result.  Unless it is a success, names the fault that is latched, if there is one. */
static void conclude(const epg_node_t *node, bool success, const char *message, const epg_status_t *status)
{
    epg_service_state_t *state = node->target->service_state;
    state->success = success;
    state->message[0] = '\0';
    add(state, message);
    if (!success && status != NULL) {
        add_fault(node, status);
    }
}

static bool fail_without_loop(const epg_node_t *node, bool late)
{
    if (late) {
        conclude(node, false, "the control loop does not run", NULL);
    }
    return late;
}

/** The reply of std_srvs/srv/SetBool and Trigger: success, message. */
static bool write_result(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    const epg_service_state_t *state = node->target->service_state;
    if (part > 0) {
        return false;
    }
    epg_reply_u8(reply, state->success ? 1 : 0);
    epg_reply_string(reply, state->message);
    return true;
}

/* Enable ------------------------------------------------------------------------------------------------------- */

static bool take_enable(epg_node_t *node, epg_cdr_reader_t *request)
{
    epg_service_state_t *state = node->target->service_state;
    const uint8_t data = epg_cdr_read_u8(request);
    if (request->failed || data > 1) {
        return false;
    }
    state->enable = data == 1;
    begin(node);
    if (state->enable && node->services_clean && !state->overtaken) {
        epg_gate_enable(node->target->control, EPG_GATE_SERVICE, EPG_ENABLE_ANY);
    }
    if (!state->enable && !state->stopped) {
        epg_stop(node->target->control, EPG_STOP_SERVICE);
    }
    return true;
}

static bool enable_ready(epg_node_t *node, bool late)
{
    const bool enable = node->target->service_state->enable;
    epg_status_t status = {0};
    const bool known = cycled(node, &status, EPG_REQUEST_SEEN) &&
                       (status.enabled == enable || cycled(node, &status, EPG_REQUEST_OVER));
    if (!known) {
        return fail_without_loop(node, late);
    }
    if (status.enabled == enable) {
        conclude(node, true, enable ? "enabled" : "disabled", &status);
    } else {
        conclude(node, false, enable ? "refused, stopped by " : "it was enabled again", NULL);
        if (enable) {
            add(node->target->service_state, epg_stop_source_name(status.stop_source));
            add_fault(node, &status);
        }
    }
    return true;
}

const epg_service_kind_t epg_service_enable = {
    .request = {.type = "std_srvs::srv::dds_::SetBool_Request_",
                .hash = EPG_TYPE_HASH("RIHS01_c62fbb99d94e1b25e8ef9e109f9581956bb1b3361a45a4e5810c36a90d29932e")},
    .reply = {.type = "std_srvs::srv::dds_::SetBool_Response_",
              .hash = EPG_TYPE_HASH("RIHS01_d0814e7f7b4880ab77e9c57426c7aa1562ab69f11eef8e2e968812f9cbd0b059")},
    .take = take_enable,
    .ready = enable_ready,
    .write = write_result,
};

/* Reset -------------------------------------------------------------------------------------------------------- */

/** A Trigger has no members.  ROS 2 sends one byte for it, which has no meaning. */
static bool take_reset(epg_node_t *node, epg_cdr_reader_t *request)
{
    (void)request;
    begin(node);
    epg_control_reset(node->target->control);
    return true;
}

static bool reset_ready(epg_node_t *node, bool late)
{
    epg_status_t status;
    if (!cycled(node, &status, EPG_REQUEST_SEEN)) {
        return fail_without_loop(node, late);
    }
    if (status.fault != EPG_FAULT_NONE) {
        conclude(node, false, "the cause remains", &status);
    } else {
        conclude(node, true, status.enabled ? "enabled" : "disabled, without a fault", &status);
    }
    return true;
}

const epg_service_kind_t epg_service_reset = {
    .request = TRIGGER_REQUEST,
    .reply = TRIGGER_REPLY,
    .take = take_reset,
    .ready = reset_ready,
    .write = write_result,
};

/* Store -------------------------------------------------------------------------------------------------------- */

static bool take_store(epg_node_t *node, epg_cdr_reader_t *request)
{
    (void)request;
    begin(node);
    return true;
}

static bool store_ready(epg_node_t *node, bool late)
{
    epg_store_t *store = node->target->store;
    epg_jog_t *jog = node->target->application->jog;
    size_t count = 0;
    epg_status_t status;
    if (!cycled(node, &status, EPG_REQUEST_SEEN)) {
        return fail_without_loop(node, late);
    }
    if (status.enabled || (jog != NULL && !epg_jog_idle(jog))) {
        conclude(node, false, "the actuators must be off: disable first", NULL);
        return true;
    }
    const char *problem = store == NULL ? "this target cannot store parameters" : epg_store_save(store, &count);
    if (problem != NULL) {
        conclude(node, false, problem, NULL);
    } else {
        char number[EPG_DECIMAL_SIZE + 1];
        number[epg_decimal_write_integer(number, (int64_t)count)] = '\0';
        conclude(node, true, number, &status);
        add(node->target->service_state, count == 1 ? " value is stored" : " values are stored");
    }
    return true;
}

const epg_service_kind_t epg_service_store_parameters = {
    .request = TRIGGER_REQUEST,
    .reply = TRIGGER_REPLY,
    .take = take_store,
    .ready = store_ready,
    .write = write_result,
};
