/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What the parts of the console share.
 */
#ifndef EPG_CONSOLE_SESSION_H
#define EPG_CONSOLE_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "console.h"
#include "output.h"

enum {
    EPG_CONSOLE_LINE = 256,  /**< longest command */
    EPG_CONSOLE_WORDS = 24,  /**< most words of a command */
    EPG_CONSOLE_WATCHED = 32 /**< most values of a watch line */
};

/** A line from outside, cut into words. */
typedef struct epg_console_command {
    size_t count;
    char *words[EPG_CONSOLE_WORDS];
} epg_console_command_t;

typedef struct epg_console_session epg_console_session_t;

/**
 * Writes line `index` of an answer, from its first word on; false, and nothing is written, behind the last one.  Called
 * again with the same index when there was no room for the line.
 */
typedef bool epg_console_list_t(epg_console_session_t *session, size_t index);

/** What keeps the next command waiting. */
typedef enum epg_console_wait {
    EPG_CONSOLE_READY,
    EPG_CONSOLE_APPLYING, /**< changes of parameters, until the control side has made them */
    EPG_CONSOLE_ENABLING, /**< a request, until a cycle has acted on it */
    EPG_CONSOLE_DISABLING
} epg_console_wait_t;

/** Lines as they come in. */
typedef struct epg_console_input {
    char line[EPG_CONSOLE_LINE + 1];
    size_t length;
    bool too_long;
    bool no_text;  /**< the line holds bytes that are no text */
    bool complete; /**< the line is to be carried out */
    bool echo;
} epg_console_input_t;

struct epg_console_session {
    const epg_target_t *target;
    const epg_console_options_t *options;
    const epg_stream_t *stream;
    uint64_t start_ns; /**< what times are counted from */
    uint64_t now_ns;
    bool connected;
    bool connected_before; /**< at any time since the start */

    epg_console_input_t input;
    epg_console_output_t output;
    uint64_t progress_ns; /**< when the stream last took something, or had nothing to take */

    epg_status_t status; /**< newest */
    bool has_status;

    epg_console_list_t *list; /**< the answer of several lines that is being written; NULL: none */
    const char *list_command; /**< that it answers; a literal */
    size_t list_index;
    size_t list_selected[EPG_CONSOLE_WORDS]; /**< what it is about, if it is not about everything */
    size_t list_count;                       /**< of `list_selected` */

    epg_console_wait_t wait;
    const char *wait_command;
    uint64_t wait_since_ns;
    uint32_t wait_cycles; /**< cycles run when it began */

    bool watching;
    size_t watched[EPG_CONSOLE_WATCHED]; /**< monitoring values */
    size_t watched_count;
    uint64_t watch_next_ns;
    uint64_t watch_shown_ns; /**< time of the values shown last */

    bool jogging;
    bool recording;
};

/* console.c ---------------------------------------------------------------------------------------------------- */

/** "ok <command>", and whatever the caller adds before epg_console_end_or_drop(). */
void epg_console_ok(epg_console_session_t *session, const char *command);

/** "error <command> <message>"; `about`, if not NULL, follows in quotes. */
void epg_console_error(epg_console_session_t *session, const char *command, const char *message, const char *about);

/** Begins an answer of several lines, which ends with "ok <command>". */
void epg_console_answer(epg_console_session_t *session, const char *command, epg_console_list_t *list);

/** Keeps the next command waiting. */
void epg_console_wait_for(epg_console_session_t *session, const char *command, epg_console_wait_t wait);

/** `fault` as one word. */
void epg_console_fault(epg_console_session_t *session, const epg_status_t *status);

/** The node's name, with the board's serial number in it. */
void epg_console_node(epg_console_session_t *session);

/** Seconds since the start of a time of epg_port_time_ns(). */
uint64_t epg_console_since_start(const epg_console_session_t *session, uint64_t time_ns);

/* input.c ------------------------------------------------------------------------------------------------------ */

/** Takes what has arrived, up to the end of a line; true if there is a line now. */
void epg_console_read(epg_console_session_t *session);

/** Forgets the line. */
void epg_console_input_clear(epg_console_input_t *input);

/** Cuts `line` into words, in place; false if there are too many. */
bool epg_console_cut(char *line, epg_console_command_t *command);

/** Cuts "name=value" in place; `*value` is a NULL pointer when there is no "=". */
void epg_console_assignment(char *word, const char **value);

/** Reads a number that is the whole of `text`. */
bool epg_console_number(const char *text, double *value);

/** Reads a whole number from 0 to `largest` that is the whole of `text`. */
bool epg_console_whole(const char *text, uint32_t largest, uint32_t *value);

/* Commands ----------------------------------------------------------------------------------------------------- */

void epg_console_help(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_version(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_stats(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_ports(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_enable(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_disable(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_setpoints(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_jog(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_get(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_set(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_save(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_watch(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_capture(epg_console_session_t *session, const epg_console_command_t *command);
void epg_console_echo(epg_console_session_t *session, const epg_console_command_t *command);

/** Looks whether the jog that was asked for has ended. */
void epg_console_poll_jog(epg_console_session_t *session);

/** Looks whether a recording has ended. */
void epg_console_poll_capture(epg_console_session_t *session);

/** Writes a watch line if one is due. */
void epg_console_poll_watch(epg_console_session_t *session);

/** Finds a signal by "inputs.name", or by its name alone if that is clear.  SIZE_MAX if there is none. */
size_t epg_console_find_signal(const epg_console_session_t *session, const char *name);

/**
 * Which value of `topic` is called `name`, which may be written without the slash it begins with; SIZE_MAX if none is.
 * Topics for other things than values have none.
 */
size_t epg_console_find_value(const epg_topic_t *topic, const char *name);

#endif
