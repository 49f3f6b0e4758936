/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The console: the connection, the commands, and the order of the answers.
 */
#include "console.h"

#include <string.h>

#include "epg/port.h"
#include "session.h"

enum {
    LINES = 1,          /* lines of an answer that are written in one poll */
    ANSWER_ROOM = 256,  /* free bytes of output that a command needs before it is carried out, */
    PATIENCE_MS = 100,  /* unless the other end has not read for this time: commands must act all the same */
    ABANDON_MS = 2000,  /* an answer of several lines ends if the other end has not read for this time */
    NO_CYCLE_MS = 1000, /* a control loop without a cycle for this time counts as stopped */
    MS = 1000000        /* ns */
};

typedef struct handler {
    const char *name;
    void (*run)(epg_console_session_t *session, const epg_console_command_t *command);
} handler_t;

static const handler_t handlers[] = {
    {"help", epg_console_help},       {"version", epg_console_version}, {"stats", epg_console_stats},
    {"ports", epg_console_ports},     {"enable", epg_console_enable},   {"disable", epg_console_disable},
    {"watch", epg_console_watch},     {"get", epg_console_get},         {"set", epg_console_set},
    {"save", epg_console_save},       {"jog", epg_console_jog},         {"echo", epg_console_echo},
    {"capture", epg_console_capture},
};

static epg_console_session_t session;

/**
 * Handles the start or the end of a connection: ends all output of the last one, and stops a jog.  Input is kept, because
 * the end of a connection can be known before the bytes that were sent before it.
 */
static void begin_session(bool connected)
{
    if (session.jogging) {
        epg_gate_end_move(session.target->control);
        session.jogging = false;
    }
    epg_console_scan_begin_line(&session.input.scan);
    session.input.echo = false;
    epg_console_end_frames(&session);
    epg_console_output_clear(&session.output);
    session.list = NULL;
    session.wait = EPG_CONSOLE_READY;
    session.watching = false;
    session.connected = connected;
    session.progress_ns = session.now_ns;
    if (!connected) {
        return;
    }
    if (session.connected_before) {
        epg_control_count_reconnect(session.target->control);
    }
    session.connected_before = true;
    epg_console_begin(&session.output, "ready");
    epg_console_node(&session);
    epg_console_word(&session.output, "epg", session.target->version);
    epg_console_word(&session.output, "hash", session.target->hash);
    if (session.has_status) {
        epg_console_stop(&session, &session.status);
    }
    epg_console_end_or_drop(&session.output);
}

/** Reports each change of the target's state, whatever its reason. */
static void poll_status(void)
{
    epg_status_t status;
    if (!epg_control_observe(session.target->control, &status)) {
        return;
    }
    const bool changed =
        session.has_status && (status.enabled != session.status.enabled || status.fault != session.status.fault ||
                               (session.output.framed && status.stop_number != session.status.stop_number));
    session.status = status;
    session.has_status = true;
    if (changed && session.connected) {
        epg_console_begin(&session.output, "state");
        epg_console_count(&session.output, "enabled", status.enabled ? 1U : 0U);
        epg_console_fault(&session, &status);
        epg_console_stop(&session, &status);
        epg_console_end_or_drop(&session.output);
    }
}

/** Returns true if the event has come that the next command waits for. */
static bool has_come(void)
{
    const uint32_t cycles = session.has_status ? session.status.statistics.cycles - session.wait_cycles : 0U;
    switch (session.wait) {
    case EPG_CONSOLE_APPLYING:
        return epg_parameters_idle(session.target->application->parameters);
    case EPG_CONSOLE_ENDING_STREAM:
        return epg_telemetry_idle(session.target->application->telemetry);
    case EPG_CONSOLE_ENABLING:
        return cycles >= (session.status.enabled ? EPG_REQUEST_SEEN : EPG_REQUEST_OVER);
    default:
        return cycles >= EPG_REQUEST_SEEN;
    }
}

/** Answers the command that the next command waits for, if it has taken effect. */
static void poll_wait(void)
{
    bool refused = false;
    const char *problem = NULL;
    if (session.wait == EPG_CONSOLE_READY) {
        return;
    }
    if (has_come()) {
        const bool enables = session.wait == EPG_CONSOLE_ENABLING && !session.status.enabled;
        refused = enables || session.wait == EPG_CONSOLE_REFUSING;
        problem = session.wait == EPG_CONSOLE_DISABLING && session.status.enabled ? "was enabled again" : NULL;
    } else if (session.now_ns - session.wait_since_ns > (uint64_t)NO_CYCLE_MS * MS) {
        problem = "the control loop does not run";
    } else {
        return;
    }
    if (problem == NULL && !refused) {
        epg_console_ok(&session, session.wait_command);
    } else {
        epg_console_begin(&session.output, "error ");
        epg_console_text(&session.output, session.wait_command);
        epg_console_text(&session.output, " ");
        if (refused) {
            epg_console_refused(&session);
        } else {
            epg_console_text(&session.output, problem);
        }
    }
    epg_console_end_or_drop(&session.output);
    session.wait = EPG_CONSOLE_READY;
}

/** Writes the next lines of an answer of several lines. */
static void poll_list(void)
{
    for (int i = 0; i < LINES && session.list != NULL; i++) {
        const bool empty = session.output.used == 0;
        const bool more = session.list(&session, session.list_index);
        if (!more) {
            epg_console_ok(&session, session.list_command);
        }
        if (!epg_console_end(&session.output)) {
            if (!empty) {
                return;
            }
            session.output.dropped++; /* the line is longer than the whole output */
        }
        session.list_index++;
        if (!more) {
            session.list = NULL;
        }
    }
}

static const handler_t *find_handler(const char *name)
{
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++) {
        if (strcmp(name, handlers[i].name) == 0) {
            return &handlers[i];
        }
    }
    return NULL;
}

/** Returns the first word of a line, and its length. */
static const char *first_word(const char *line, size_t *length)
{
    const char *word = line + strspn(line, " \t");
    *length = strcspn(word, " \t");
    return word;
}

/** Returns true for a line that must act at once, even during another answer: setpoints, enable, disable. */
static bool urgent(void)
{
    size_t length;
    const char *word = first_word(session.input.line, &length);
    return memchr(word, '=', length) != NULL || (length == 6 && memcmp(word, "enable", length) == 0) ||
           (length == 7 && memcmp(word, "disable", length) == 0) || session.input.is_stop;
}

static void run_line(void)
{
    epg_console_command_t command;
    session.output.tag = session.input.tag;
    if (session.input.is_stop) { /* whatever was left of a line before it */
        epg_console_disable(&session, NULL);
    } else if (session.input.too_long) {
        epg_console_error(&session, "line", "is too long", NULL);
    } else if (session.input.no_text) {
        epg_console_error(&session, "line", "contains bytes that are not text", NULL);
    } else if (!epg_console_cut(session.input.line, &command)) {
        epg_console_error(&session, "line", "has too many words", NULL);
    } else if (command.count > 0) {
        const handler_t *handler = find_handler(command.words[0]);
        if (handler != NULL) {
            handler->run(&session, &command);
        } else if (strchr(command.words[0], '=') != NULL) {
            epg_console_setpoints(&session, &command);
        } else {
            epg_console_error(&session, "line", "there is no command", command.words[0]);
        }
    }
    epg_console_input_clear(&session.input);
    session.output.tag = 0;
}

static void poll_input(void)
{
    const uint64_t idle_ns = session.now_ns - session.progress_ns;
    if (session.list != NULL && idle_ns > (uint64_t)ABANDON_MS * MS) {
        session.list = NULL;
        session.output.dropped++;
    }
    epg_console_read(&session);
    if (!session.input.complete || session.wait != EPG_CONSOLE_READY) {
        return;
    }
    session.input.line[session.input.length] = '\0';
    const bool starting = !session.has_status && session.now_ns - session.start_ns < (uint64_t)NO_CYCLE_MS * MS;
    const bool room = epg_console_output_room(&session.output) >= ANSWER_ROOM || idle_ns > (uint64_t)PATIENCE_MS * MS;
    if (room && ((session.list == NULL && !starting) || urgent())) {
        run_line();
    }
}

static void start(const epg_target_t *target, const epg_stream_t *stream)
{
    const bool alone = target->middleware == &epg_console;
    const epg_console_options_t *options = alone ? target->options : target->console_options;
    session = (epg_console_session_t){
        .target = target,
        .options = options,
        .stream = stream,
        .start_ns = epg_port_time_ns(),
        .output = {.bytes = options->output, .size = options->output_size},
    };
}

static void poll(uint64_t now_ns)
{
    session.now_ns = now_ns;
    session.clean = epg_gate_poll(session.target->control, EPG_GATE_CONSOLE);
    const bool connected = session.stream->connected(session.stream->context);
    if (connected != session.connected) {
        begin_session(connected);
    }
    poll_status();
    session.output.tag = session.live.wait_tag;
    poll_wait();
    session.output.tag = session.live.jog_tag;
    epg_console_poll_jog(&session);
    session.output.tag = 0;
    epg_console_poll_capture(&session);
    poll_input();
    epg_console_poll_scan(&session);
    session.output.tag = session.live.list_tag;
    poll_list();
    session.output.tag = 0;
    epg_console_poll_watch(&session);
    epg_console_poll_live(&session);
    if (!connected) { /* commands act, but nobody reads their answers */
        epg_console_output_clear(&session.output);
        session.list = NULL;
    }
    if (session.output.used == 0 || epg_console_send(&session.output, session.stream)) {
        session.progress_ns = now_ns;
    }
}

const epg_middleware_t epg_console = {.start = start, .poll = poll};
