/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The commands get, set and save, for parameters and for the names of the node.
 */
#include "epg/parameters.h"

#include <string.h>

#include "epg/finite.h"
#include "epg/names.h"
#include "epg/store.h"
#include "session.h"

static size_t find(const epg_parameters_t *parameters, const char *name)
{
    for (size_t i = 0; i < parameters->count; i++) {
        if (strcmp(parameters->table[i].name, name) == 0) {
            return i;
        }
    }
    return SIZE_MAX;
}

/** Returns the parameters.  If there are none, reports this and returns NULL. */
static epg_parameters_t *parameters_of(epg_console_session_t *session, const char *command)
{
    epg_parameters_t *parameters = session->target->application->parameters;
    if (parameters == NULL) {
        epg_console_error(session, command, "the model has no parameters", NULL);
    }
    return parameters;
}

static bool parameter_line(epg_console_session_t *session, size_t index)
{
    const epg_parameters_t *parameters = session->target->application->parameters;
    epg_console_output_t *output = &session->output;
    if (index >= (session->list_count > 0 ? session->list_count : parameters->count)) {
        return false;
    }
    const size_t number = session->list_count > 0 ? session->list_selected[index] : index;
    const epg_parameter_t *parameter = &parameters->table[number];
    const double value = epg_parameters_value(parameters, number);
    epg_console_begin(output, "parameter");
    epg_console_value(output, parameter->name, value);
    epg_console_unit(output, parameter->unit);
    if (memcmp(&value, &parameter->value, sizeof value) != 0) {
        epg_console_value(output, "generated", parameter->value);
    }
    if (parameters->limits != NULL && epg_is_finite(parameters->limits[number].minimum)) {
        epg_console_value(output, "min", parameters->limits[number].minimum);
    }
    if (parameters->limits != NULL && epg_is_finite(parameters->limits[number].maximum)) {
        epg_console_value(output, "max", parameters->limits[number].maximum);
    }
    return true;
}

/* Names -------------------------------------------------------------------------------------------------------- */

static bool is_name(const char *word)
{
    return strcmp(word, "node") == 0 || strcmp(word, "namespace") == 0;
}

/** Answers with the name as it is stored, and with the board's serial number in it. */
static void tell_name(epg_console_session_t *session, const char *word)
{
    const epg_target_t *target = session->target;
    const char *space = epg_names_space(target);
    const char *pattern = strcmp(word, "node") == 0 ? epg_names_node(target) : space[0] == '\0' ? "/" : space;
    char name[EPG_STORE_NAME_SIZE];
    (void)epg_names_expand(pattern, name, sizeof name);
    epg_console_ok(session, "get");
    epg_console_word(&session->output, word, pattern);
    epg_console_word(&session->output, "name", name);
    epg_console_end_or_drop(&session->output);
}

static void set_name(epg_console_session_t *session, const char *word, const char *text)
{
    const epg_target_t *target = session->target;
    const bool node = strcmp(word, "node") == 0;
    const bool good = node ? epg_names_set_node(target, text) : epg_names_set_space(target, text);
    if (target->store == NULL) {
        epg_console_error(session, "set", "this target cannot store names", NULL);
    } else if (!good) {
        epg_console_error(session, "set", node ? "this is not a name of a node:" : "this is not a namespace:", text);
    } else {
        epg_console_ok(session, "set");
        epg_console_word(&session->output, "acts", "at_next_start_if_saved");
        epg_console_end_or_drop(&session->output);
    }
}

/* Parameters --------------------------------------------------------------------------------------------------- */

void epg_console_get(epg_console_session_t *session, const epg_console_command_t *command)
{
    if (command->count == 2 && is_name(command->words[1])) {
        tell_name(session, command->words[1]);
        return;
    }
    const epg_parameters_t *parameters = parameters_of(session, "get");
    if (parameters == NULL) {
        return;
    }
    session->list_count = 0;
    for (size_t i = 1; i < command->count; i++) {
        const size_t index = find(parameters, command->words[i]);
        if (index == SIZE_MAX) {
            epg_console_error(session, "get", "there is no parameter", command->words[i]);
            return;
        }
        session->list_selected[session->list_count++] = index;
    }
    epg_console_answer(session, "get", parameter_line);
}

/** Carries out a command that sets a name.  Returns false for a command that sets parameters. */
static bool sets_name(epg_console_session_t *session, const epg_console_command_t *command)
{
    char *assignment = command->count == 2 ? strchr(command->words[1], '=') : NULL;
    if (assignment == NULL) {
        return false;
    }
    *assignment = '\0';
    const bool name = is_name(command->words[1]);
    if (name) {
        set_name(session, command->words[1], assignment + 1);
    } else {
        *assignment = '=';
    }
    return name;
}

/** Reports a number that is outside of the limits of its parameter. */
static void refuse_number(epg_console_session_t *session, const epg_parameter_limits_t *limits, double value,
                          const char *text)
{
    epg_console_output_t *output = &session->output;
    const bool less = value < limits->minimum;
    epg_console_begin(output, "error set this number is ");
    epg_console_text(output, less ? "less than the minimum " : "more than the maximum ");
    epg_console_double(output, less ? limits->minimum : limits->maximum);
    epg_console_text(output, ": '");
    epg_console_text(output, text);
    epg_console_text(output, "'");
    epg_console_end_or_drop(output);
}

void epg_console_set(epg_console_session_t *session, const epg_console_command_t *command)
{
    if (sets_name(session, command)) {
        return;
    }
    epg_parameters_t *parameters = parameters_of(session, "set");
    epg_parameter_change_t changes[EPG_CONSOLE_CHANGES];
    if (parameters == NULL) {
        return;
    }
    if (command->count == 1 || command->count - 1U > EPG_CONSOLE_CHANGES) {
        epg_console_error(session, "set", "use <parameter>=<number>, 1 to 8 times", NULL);
        return;
    }
    for (size_t i = 1; i < command->count; i++) {
        const char *text;
        epg_console_assignment(command->words[i], &text);
        const size_t index = find(parameters, command->words[i]);
        double value;
        if (index == SIZE_MAX) {
            epg_console_error(session, "set", "there is no parameter", command->words[i]);
            return;
        }
        if (text == NULL || !epg_console_number(text, &value)) {
            epg_console_error(session, "set", "this is not a number:", text == NULL ? "" : text);
            return;
        }
        if (!epg_parameters_can_be(parameters, index, value)) {
            refuse_number(session, &parameters->limits[index], value, text);
            return;
        }
        changes[i - 1U] = (epg_parameter_change_t){.index = index, .value = value};
    }
    if (epg_parameters_change(parameters, changes, command->count - 1U)) {
        epg_console_wait_for(session, "set", EPG_CONSOLE_APPLYING);
    } else {
        epg_console_error(session, "set", "the control loop does not run", NULL);
    }
}

void epg_console_save(epg_console_session_t *session, const epg_console_command_t *command)
{
    (void)command;
    epg_store_t *store = session->target->store;
    size_t count = 0;
    if (store == NULL) {
        epg_console_error(session, "save", "there is nothing to save", NULL);
        return;
    }
    if (!session->has_status || session->status.enabled || session->jogging) {
        epg_console_error(session, "save", "the actuators must be off: disable first", NULL);
        return;
    }
    const char *problem = epg_store_save(store, &count);
    if (problem != NULL) {
        epg_console_error(session, "save", problem, NULL);
    } else {
        epg_console_ok(session, "save");
        epg_console_count(&session->output, "values", (uint32_t)count);
        epg_console_end_or_drop(&session->output);
    }
}
