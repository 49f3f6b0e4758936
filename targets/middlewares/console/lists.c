/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The commands that give information: help, version, stats, ports.
 */
#include <stddef.h>
#include <string.h>

#include "epg/middleware.h"
#include "epg/node.h"
#include "epg/store.h"
#include "session.h"

enum { VERSION_ROOM = 384 /* bytes that the last line of `version` needs */ };

static const char *const help[] = {
    "ports                        the names of all ports",
    "<setpoint>=<number> ...      sets setpoints; all of one line act in the same cycle",
    "enable, disable              actuators on (initialises the model, clears a fault); off",
    "watch [<port> ...], off      shows values at the communication period, one cycle per line",
    "stats                        counters of the control loop",
    "get [<parameter> ...]        parameters of the model",
    "set <parameter>=<number> ... changes up to 8 parameters in the same cycle",
    "get|set node, namespace      names of the ROS 2 node after the next start: set node=robot_$serial",
    "save                         stores the changes; only while disabled",
    "capture <port> ... [rows=<n>] [before=<n>] [every=<n>] [when=<port>><number>|when=fault]",
    "capture [read|stop]          progress of the recording; shows its rows; ends it",
    "jog <actuator> <duty> <ms>   moves an actuator while disabled, and shows the encoders' counts",
    "echo on|off                  shows the typed characters",
    "version",
};

static bool help_line(epg_console_session_t *session, size_t index)
{
    if (index >= sizeof help / sizeof help[0]) {
        return false;
    }
    epg_console_begin(&session->output, "help ");
    epg_console_text(&session->output, help[index]);
    return true;
}

void epg_console_help(epg_console_session_t *session, const epg_console_command_t *command)
{
    (void)command;
    epg_console_answer(session, "help", help_line);
}

static const char *stored_name(const epg_parameters_t *parameters)
{
    static const char *const words[] = {
        [EPG_STORED_NOTHING] = "nothing", [EPG_STORED_DAMAGED] = "damaged", [EPG_STORED_FOR_OTHER] = "of_another_model",
        [EPG_STORED_PARTLY] = "partly",   [EPG_STORED_LOADED] = "loaded",   [EPG_STORED_SAVED] = "saved",
    };
    return words[parameters->stored];
}

/** Names the stored parameters that were refused, as many as the output has room for. */
static void tell_refused(epg_console_session_t *session)
{
    const epg_store_t *store = session->target->store;
    const char *name = store != NULL ? epg_store_refused(store, 0) : NULL;
    for (size_t i = 1; name != NULL; i++) {
        epg_console_begin(&session->output, "refused ");
        epg_console_text(&session->output, name);
        epg_console_end_or_drop(&session->output);
        name = epg_console_output_room(&session->output) > VERSION_ROOM ? epg_store_refused(store, i) : NULL;
    }
}

void epg_console_version(epg_console_session_t *session, const epg_console_command_t *command)
{
    const epg_target_t *target = session->target;
    (void)command;
    tell_refused(session);
    epg_console_ok(session, "version");
    epg_console_word(&session->output, "name", target->application->name);
    epg_console_node(session);
    epg_console_word(&session->output, "epg", target->version);
    epg_console_word(&session->output, "hash", target->hash);
    epg_console_word(&session->output, "model", target->model);
    epg_console_key(&session->output, "period");
    epg_console_seconds(&session->output, target->application->period_ns);
    if (target->application->parameters != NULL) {
        epg_console_word(&session->output, "stored", stored_name(target->application->parameters));
    }
    epg_console_end_or_drop(&session->output);
}

static const struct {
    const char *name;
    size_t offset; /* place of a uint32_t in epg_statistics_t */
} counters[] = {
    {"cycles", offsetof(epg_statistics_t, cycles)},
    {"overruns", offsetof(epg_statistics_t, overruns)},
    {"outputs_late", offsetof(epg_statistics_t, outputs_late)},
    {"missed", offsetof(epg_statistics_t, missed)},
    {"lateness_max_ns", offsetof(epg_statistics_t, lateness_max)},
    {"computation_min_ns", offsetof(epg_statistics_t, computation_min)},
    {"computation_max_ns", offsetof(epg_statistics_t, computation_max)},
    {"clamped", offsetof(epg_statistics_t, clamped)},
    {"setpoints_dropped", offsetof(epg_statistics_t, setpoints_dropped)},
    {"setpoint_timeouts", offsetof(epg_statistics_t, setpoint_timeouts)},
    {"faults", offsetof(epg_statistics_t, faults)},
    {"reconnects", offsetof(epg_statistics_t, reconnects)},
    {"silence_max", offsetof(epg_statistics_t, silence_max)},
    {"control_stack_used", offsetof(epg_statistics_t, stacks[EPG_STACK_CONTROL].used)},
    {"control_stack_size", offsetof(epg_statistics_t, stacks[EPG_STACK_CONTROL].size)},
    {"communication_stack_used", offsetof(epg_statistics_t, stacks[EPG_STACK_COMMUNICATION].used)},
    {"communication_stack_size", offsetof(epg_statistics_t, stacks[EPG_STACK_COMMUNICATION].size)},
};

enum { COUNTERS = sizeof counters / sizeof counters[0] };

/** Returns the state of the connection of the middleware beside the console; NULL if it has none. */
static const char *connection(const epg_target_t *target)
{
    const epg_middleware_t *middleware = target->middleware;
    return middleware != NULL && middleware->state != NULL ? middleware->state() : NULL;
}

static void put_state(epg_console_session_t *session)
{
    const epg_status_t *status = &session->status;
    epg_console_output_t *output = &session->output;
    epg_console_count(output, "enabled", status->enabled ? 1U : 0U);
    if (status->enabled && status->leased) {
        epg_console_count(output, "leased", 1U);
    }
    epg_console_fault(session, status);
    epg_console_stop(session, status);
    epg_console_key(output, "time");
    epg_console_seconds(output, epg_console_since_start(session, status->time_ns));
}

/** Line 0 is the target's state.  Then come the counters, the mean computed from them, and the counters of a node. */
static bool stats_line(epg_console_session_t *session, size_t index)
{
    const epg_status_t *status = &session->status;
    epg_console_output_t *output = &session->output;
    const epg_node_t *node = session->target->node_state;
    const char *connected = connection(session->target);
    if (index > COUNTERS + 2U + (node != NULL ? 2U : 0U) + (node != NULL && connected != NULL ? 1U : 0U)) {
        return false;
    }
    epg_console_begin(output, "stat");
    if (index == 0) {
        put_state(session);
    } else if (index <= COUNTERS) {
        const unsigned char *statistics = (const unsigned char *)&status->statistics;
        uint32_t value;
        memcpy(&value, statistics + counters[index - 1U].offset, sizeof value);
        epg_console_count(output, counters[index - 1U].name, value);
    } else if (index == COUNTERS + 1U) {
        const uint32_t cycles = status->statistics.cycles;
        epg_console_key(output, "computation_mean_ns");
        epg_console_integer(output, cycles == 0 ? 0 : (int64_t)(status->statistics.computation_total / cycles));
    } else if (index == COUNTERS + 2U || node == NULL) {
        epg_console_count(output, "lines_dropped", output->dropped);
    } else if (index == COUNTERS + 3U) {
        epg_console_count(output, "unsent", node->unsent);
    } else if (index == COUNTERS + 4U) {
        epg_console_count(output, "malformed", node->malformed);
    } else {
        epg_console_word(output, "connection", connected);
    }
    return true;
}

void epg_console_stats(epg_console_session_t *session, const epg_console_command_t *command)
{
    (void)command;
    if (!session->has_status) {
        epg_console_error(session, "stats", "no control cycle has run yet", NULL);
        return;
    }
    epg_console_answer(session, "stats", stats_line);
}

static void port(epg_console_session_t *session, const char *category, const char *name, const char *unit)
{
    epg_console_begin(&session->output, "port ");
    epg_console_text(&session->output, category);
    epg_console_text(&session->output, " ");
    epg_console_text(&session->output, name);
    epg_console_unit(&session->output, unit);
}

/** Writes line `*index` of the values of `topics`.  Returns false if there are fewer; subtracts their number then. */
static bool publication_line(epg_console_session_t *session, const epg_topic_t *topics, size_t count, size_t *index)
{
    for (size_t i = 0; i < count; i++) {
        const size_t values = topics[i].role == EPG_TOPIC_VALUES ? topics[i].count : 0;
        if (*index < values) {
            port(session, "publication", epg_topic_value_name(&topics[i], *index), "");
            return true;
        }
        *index -= values;
    }
    return false;
}

/** The value that setpoint `index` would have after an enabling now, as far as the communication side knows it. */
static double start_of(const epg_console_session_t *session, size_t index)
{
    const epg_setpoint_t *setpoint = &session->target->application->setpoints[index];
    const epg_setpoint_sample_t *newest = &session->target->application->received[index];
    const bool old = setpoint->timeout_ns > 0 && session->now_ns > newest->received_ns &&
                     session->now_ns - newest->received_ns > setpoint->timeout_ns;
    if (newest->count == 0 || setpoint->fresh || (old && setpoint->action == EPG_TIMEOUT_DISABLE)) {
        return setpoint->initial;
    }
    return old && setpoint->action == EPG_TIMEOUT_ZERO ? 0.0 : newest->value;
}

/** Writes the line of setpoint `index`. */
static void setpoint_line(epg_console_session_t *session, size_t index)
{
    const epg_setpoint_t *setpoint = &session->target->application->setpoints[index];
    epg_console_output_t *output = &session->output;
    port(session, "setpoint", epg_target_setpoint(session->target, index),
         setpoint->unit == NULL ? "" : setpoint->unit);
    if (epg_setpoint_is_limited(setpoint)) {
        epg_console_value(output, "min", setpoint->minimum);
        epg_console_value(output, "max", setpoint->maximum);
    }
    if (setpoint->follows != NULL) {
        epg_console_word(output, "follows", setpoint->follows);
    } else {
        epg_console_value(output, "starts", start_of(session, index));
    }
    if (setpoint->fresh) {
        epg_console_count(output, "fresh", 1U);
    }
}

static const char *const loop_values[EPG_LOOP_VALUES] = {
    [EPG_LOOP_LATENESS] = "lateness",
    [EPG_LOOP_COMPUTATION] = "computation",
};

static const char *const replay_values[EPG_REPLAY_VALUES] = {
    [EPG_REPLAY_CYCLE] = "cycle", [EPG_REPLAY_PARAMETER] = "parameter", [EPG_REPLAY_VALUE] = "value",
    [EPG_REPLAY_ACTED] = "acted", [EPG_REPLAY_UNTOLD] = "untold",
};

static bool ports_line(epg_console_session_t *session, size_t index)
{
    const epg_target_t *target = session->target;
    const epg_jog_t *jog = target->application->jog;
    if (index < target->application->setpoint_count) {
        setpoint_line(session, index);
        return true;
    }
    index -= target->application->setpoint_count;
    if (publication_line(session, target->publications, target->publication_count, &index)) {
        return true;
    }
    if (index < target->signal_count) {
        port(session, "signal", target->signals[index].name, target->signals[index].unit);
        return true;
    }
    index -= target->signal_count;
    if (target->application->telemetry != NULL) {
        if (index < EPG_LOOP_VALUES) {
            port(session, "loop", loop_values[index], "ns");
            return true;
        }
        index -= EPG_LOOP_VALUES;
        if (index < EPG_REPLAY_VALUES) {
            port(session, "replay", replay_values[index], "");
            return true;
        }
        index -= EPG_REPLAY_VALUES;
    }
    if (jog != NULL && index < jog->actuator_count) {
        port(session, "actuator", jog->actuators[index].name, "");
        return true;
    }
    index -= jog != NULL ? jog->actuator_count : 0U;
    if (jog != NULL && index < jog->encoder_count) {
        port(session, "encoder", jog->encoders[index].name, jog->encoders[index].unit);
        return true;
    }
    return false;
}

void epg_console_ports(epg_console_session_t *session, const epg_console_command_t *command)
{
    (void)command;
    epg_console_answer(session, "ports", ports_line);
}

size_t epg_console_find_value(const epg_topic_t *topic, const char *name)
{
    const size_t count = topic->role == EPG_TOPIC_VALUES ? topic->count : 0;
    for (size_t i = 0; i < count; i++) {
        const char *value = epg_topic_value_name(topic, i);
        if (strcmp(value, name) == 0 || (value[0] == '/' && strcmp(value + 1, name) == 0)) {
            return i;
        }
    }
    return SIZE_MAX;
}

size_t epg_console_find_signal(const epg_console_session_t *session, const char *name)
{
    const epg_target_t *target = session->target;
    size_t found = SIZE_MAX;
    for (size_t i = 0; i < target->signal_count; i++) {
        const char *signal = target->signals[i].name;
        const char *last = strchr(signal, '.');
        if (strcmp(signal, name) == 0) {
            return i;
        }
        if (last != NULL && strcmp(last + 1, name) == 0) {
            if (found != SIZE_MAX) {
                return SIZE_MAX; /* ambiguous: an input and an output have this name */
            }
            found = i;
        }
    }
    return found;
}
