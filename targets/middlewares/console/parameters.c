/**
 * @file
 * Commands about parameters: get, set, save.
 */
#include "epg/parameters.h"

#include <string.h>

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

/** The parameters, or NULL after reporting that there are none. */
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
    epg_console_key(output, parameter->name);
    epg_console_double(output, value);
    if (parameter->unit[0] != '\0') {
        epg_console_key(output, "unit");
        epg_console_text(output, parameter->unit);
    }
    if (memcmp(&value, &parameter->value, sizeof value) != 0) {
        epg_console_key(output, "generated");
        epg_console_double(output, parameter->value);
    }
    return true;
}

void epg_console_get(epg_console_session_t *session, const epg_console_command_t *command)
{
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

void epg_console_set(epg_console_session_t *session, const epg_console_command_t *command)
{
    epg_parameters_t *parameters = parameters_of(session, "set");
    epg_parameter_change_t changes[EPG_PARAMETER_CHANGES];
    if (parameters == NULL) {
        return;
    }
    if (command->count == 1 || command->count - 1U > EPG_PARAMETER_CHANGES) {
        epg_console_error(session, "set", "<parameter>=<number>, from 1 to 8 of them", NULL);
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
            epg_console_error(session, "set", "this is no number:", text == NULL ? "" : text);
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
    epg_parameters_t *parameters = parameters_of(session, "save");
    size_t count = 0;
    if (parameters == NULL) {
        return;
    }
    if (!session->has_status || session->status.enabled || session->jogging) {
        epg_console_error(session, "save", "only while actuators are off: disable first", NULL);
    } else if (!epg_parameters_save(parameters, &count)) {
        epg_console_error(session, "save", "nothing can be stored here", NULL);
    } else {
        epg_console_ok(session, "save");
        epg_console_count(&session->output, "values", (uint32_t)count);
        epg_console_end_or_drop(&session->output);
    }
}
