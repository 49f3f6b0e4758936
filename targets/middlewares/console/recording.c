/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The command capture: records signals in control cycles, and sends the rows afterwards.
 */
#include <string.h>

#include "epg/capture.h"
#include "session.h"

/** Returns the signal in a column of the last recording. */
static const epg_signal_t *recorded_signal(const epg_console_session_t *session, size_t column)
{
    const epg_target_t *target = session->target;
    const epg_capture_request_t *request = &target->application->capture->request;
    for (size_t i = 0; i < target->signal_count; i++) {
        if (target->signals[i].value == request->signals[column]) {
            return &target->signals[i];
        }
    }
    return NULL;
}

/** Line 0 is the header; then come the rows. */
static bool row_line(epg_console_session_t *session, size_t index)
{
    const epg_capture_t *capture = session->target->application->capture;
    epg_console_output_t *output = &session->output;
    const size_t columns = capture->request.columns;
    if (index == 0) {
        epg_console_begin(output, "csv time");
        for (size_t i = 0; i < columns; i++) {
            const epg_signal_t *signal = recorded_signal(session, i);
            epg_console_text(output, ",");
            epg_console_text(output, signal != NULL ? signal->name : "?");
        }
        return true;
    }
    uint64_t tick_ns;
    const double *values;
    if (!epg_capture_row(capture, index - 1U, &tick_ns, &values)) {
        return false;
    }
    epg_console_begin(output, "csv ");
    epg_console_seconds(output, epg_console_since_start(session, tick_ns));
    for (size_t i = 0; i < columns; i++) {
        epg_console_text(output, ",");
        epg_console_double(output, values[i]);
    }
    return true;
}

/**
 * Reads the value of "when=": "<port>><number>", "<port><<number>" or "fault".  Reports a mistake and returns false.
 */
static bool read_trigger(epg_console_session_t *session, const char *text, epg_capture_request_t *request)
{
    char name[EPG_CONSOLE_LINE];
    if (strcmp(text, "fault") == 0) {
        request->trigger = EPG_CAPTURE_FAULT;
        return true;
    }
    const char *sign = strchr(text, '>');
    if (sign == NULL) {
        sign = strchr(text, '<');
    }
    const size_t length = sign != NULL ? (size_t)(sign - text) : sizeof name;
    if (length >= sizeof name) {
        epg_console_error(session, "capture", "use when=<port>><number>, when=<port><<number> or when=fault", NULL);
        return false;
    }
    memcpy(name, text, length);
    name[length] = '\0';
    const size_t signal = epg_console_find_signal(session, name);
    if (signal == SIZE_MAX) {
        epg_console_error(session, "capture", "there is no port", name);
        return false;
    }
    if (!epg_console_number(sign + 1, &request->level)) {
        epg_console_error(session, "capture", "this is not a number:", sign + 1);
        return false;
    }
    request->watched = session->target->signals[signal].value;
    request->trigger = *sign == '>' ? EPG_CAPTURE_RISING : EPG_CAPTURE_FALLING;
    return true;
}

/** Reads a setting "name=value".  Reports a mistake and returns false. */
static bool read_setting(epg_console_session_t *session, const char *name, const char *text,
                         epg_capture_request_t *request)
{
    uint32_t number;
    if (strcmp(name, "when") == 0) {
        return read_trigger(session, text, request);
    }
    const bool good = epg_console_whole(text, 1000000U, &number);
    if (good && strcmp(name, "rows") == 0 && number > 0) {
        request->rows = number;
    } else if (good && strcmp(name, "before") == 0) {
        request->before = number;
    } else if (good && strcmp(name, "every") == 0 && number > 0) {
        request->every = number;
    } else {
        epg_console_error(session, "capture", "use rows=<n>, before=<n> or every=<n>, not", name);
        return false;
    }
    return true;
}

/** Reads the ports and settings of a command.  Reports a mistake and returns false. */
static bool read_request(epg_console_session_t *session, const epg_console_command_t *command,
                         epg_capture_request_t *request)
{
    for (size_t i = 1; i < command->count; i++) {
        const char *text;
        epg_console_assignment(command->words[i], &text);
        if (text != NULL) {
            if (!read_setting(session, command->words[i], text, request)) {
                return false;
            }
            continue;
        }
        const size_t signal = epg_console_find_signal(session, command->words[i]);
        if (signal == SIZE_MAX) {
            epg_console_error(session, "capture", "there is no port", command->words[i]);
            return false;
        }
        if (request->columns == EPG_CAPTURE_SIGNALS) {
            epg_console_error(session, "capture", "a recording has at most 8 ports", NULL);
            return false;
        }
        request->signals[request->columns++] = session->target->signals[signal].value;
    }
    if (request->columns == 0) {
        epg_console_error(session, "capture", "name the ports to record", NULL);
    }
    return request->columns > 0;
}

static void start(epg_console_session_t *session, const epg_console_command_t *command, epg_capture_t *capture)
{
    epg_capture_request_t request = {.every = 1, .trigger = EPG_CAPTURE_NOW};
    if (!read_request(session, command, &request)) {
        return;
    }
    const size_t most = epg_capture_rows(capture, request.columns);
    request.rows = request.rows == 0 ? most : request.rows;
    if (most == 0 || request.rows > most) {
        epg_console_begin(&session->output, "error capture there is only room for rows=");
        epg_console_integer(&session->output, (int64_t)most);
        epg_console_end_or_drop(&session->output);
    } else if (request.before >= request.rows) {
        epg_console_error(session, "capture", "before= must be less than rows=", NULL);
    } else if (!epg_capture_start(capture, &request)) {
        epg_console_error(session, "capture", "a recording runs: 'capture stop' ends it", NULL);
    } else {
        session->recording = true;
        epg_console_ok(session, "capture");
        epg_console_count(&session->output, "rows", (uint32_t)request.rows);
        epg_console_end_or_drop(&session->output);
    }
}

static void tell(epg_console_session_t *session, const char *first, epg_capture_t *capture)
{
    const bool idle = epg_capture_idle(capture);
    epg_console_begin(&session->output, first);
    epg_console_word(&session->output, "state", idle ? "ready" : "recording");
    epg_console_count(&session->output, "rows", (uint32_t)epg_capture_recorded(capture));
    if (idle && capture->triggered) {
        epg_console_count(&session->output, "trigger", (uint32_t)epg_capture_trigger_row(capture));
    }
    epg_console_end_or_drop(&session->output);
}

void epg_console_capture(epg_console_session_t *session, const epg_console_command_t *command)
{
    epg_capture_t *capture = session->target->application->capture;
    const char *word = command->count == 2 ? command->words[1] : "";
    if (capture == NULL) {
        epg_console_error(session, "capture", "this target has no memory for recordings", NULL);
    } else if (command->count == 1) {
        tell(session, "ok capture", capture);
    } else if (strcmp(word, "stop") == 0) {
        epg_capture_stop(capture);
        epg_console_done(session, "capture");
    } else if (strcmp(word, "read") != 0) {
        start(session, command, capture);
    } else if (!epg_capture_idle(capture)) {
        epg_console_error(session, "capture", "a recording runs: 'capture stop' ends it", NULL);
    } else {
        epg_console_answer(session, "capture", row_line);
    }
}

void epg_console_poll_capture(epg_console_session_t *session)
{
    epg_capture_t *capture = session->target->application->capture;
    if (session->recording && epg_capture_idle(capture)) {
        session->recording = false;
        tell(session, "captured", capture);
    }
}
