/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The state of the console, and the functions that its source files share.
 */
#ifndef EPG_CONSOLE_SESSION_H
#define EPG_CONSOLE_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/middleware.h"
#include "output.h"
#include "scan.h"

enum {
    EPG_CONSOLE_LINE = 256,  /**< bytes of the longest command */
    EPG_CONSOLE_WORDS = 24,  /**< largest number of words in a command */
    EPG_CONSOLE_CHANGES = 8, /**< largest number of parameters in a set command */
    EPG_CONSOLE_WATCHED = 32 /**< largest number of values in a watch line */
};

/** A command: a received line, split into words. */
typedef struct epg_console_command {
    size_t count;
    char *words[EPG_CONSOLE_WORDS];
} epg_console_command_t;

typedef struct epg_console_session epg_console_session_t;

/**
 * Begins and writes line `index` of an answer, without its end.  Returns false, and writes nothing, after the last
 * line.  It is called again with the same index if there was no room for the line.
 */
typedef bool epg_console_list_t(epg_console_session_t *session, size_t index);

/** The event that the next command waits for. */
typedef enum epg_console_wait {
    EPG_CONSOLE_READY,        /**< none */
    EPG_CONSOLE_APPLYING,     /**< the control side makes changes of parameters */
    EPG_CONSOLE_ENABLING,     /**< a cycle acts on a request to enable */
    EPG_CONSOLE_DISABLING,    /**< a cycle acts on a request to disable */
    EPG_CONSOLE_REFUSING,     /**< a cycle takes the stop because of which the command is refused */
    EPG_CONSOLE_ENDING_STREAM /**< a cycle ends the stream */
} epg_console_wait_t;

enum {
    EPG_CONSOLE_READ = 64,  /**< bytes that are read from the stream at once, at most */
    EPG_CONSOLE_CHUNK = 256 /**< bytes that can wait behind a command, already searched for stops */
};

/** The line that is being received. */
typedef struct epg_console_input {
    char chunk[EPG_CONSOLE_CHUNK]; /**< bytes that were read from the stream */
    size_t chunk_length;
    size_t chunk_position; /**< the next byte of the chunk; the bytes after the end of a line wait here */
    size_t stop_position;  /**< end of the last stop in the chunk; 0: there is none */
    size_t clean_position; /**< nothing has stopped the target since the bytes behind it arrived (epg_gate_poll()) */
    epg_console_scan_t scan;
    uint64_t byte_ns;                                            /**< time at which the last chunk was read */
    char line[2 + EPG_CONSOLE_LINE + EPG_CONSOLE_FRAME_CRC + 1]; /**< also holds a frame with a type and a tag */
    size_t length;
    uint8_t tag; /**< of the frame with the line; 0: the line was not in a frame */
    bool too_long;
    bool no_text;  /**< the line contains bytes that are not ASCII text */
    bool complete; /**< the line has ended and must be carried out */
    bool may_move; /**< no stop has come since the line arrived: it may move the target */
    bool stopped;  /**< no later stop of the chunk: the search has stopped the target for it already */
    bool is_stop;  /**< it is a stop that the search has found */
    bool echo;     /**< received characters are sent back */
} epg_console_input_t;

enum { EPG_CONSOLE_NUMBERS = 8 };

/** The state of the connection to a program (live.c). */
typedef struct epg_console_live {
    epg_console_frame_t frame;
    uint64_t byte_ns;  /**< arrival of the last byte of an open frame */
    uint64_t heard_ns; /**< arrival of the last whole frame */
    uint8_t wait_tag;  /**< tag of the command that waits for an event */
    uint8_t list_tag;  /**< tag of the command whose answer has several lines */
    uint8_t jog_tag;   /**< tag of the last jog */

    bool leased;       /**< numbers are sent for the lease of an enabling */
    uint64_t moved_ns; /**< numbers are sent for a movement by hand until this time */
    uint32_t number;   /**< newest number */
    uint32_t returned; /**< newest number that came back */
    uint64_t
        sent_ns[EPG_CONSOLE_NUMBERS]; /**< when the newest numbers were sent, at index number % EPG_CONSOLE_NUMBERS */
    uint64_t number_ns;               /**< when the next number must be sent */

    bool streaming;
    size_t columns;
    size_t value_size; /**< bytes of a value in a frame: 4 or 8 */
    size_t most;       /**< largest number of rows in a frame */
    uint64_t row_ns;   /**< time between two rows */
} epg_console_live_t;

struct epg_console_session {
    const epg_target_t *target;
    const struct epg_console_options *options;
    const epg_stream_t *stream;
    uint64_t start_ns; /**< time 0 of all times in answers, in board time */
    uint64_t now_ns;   /**< board time of this poll */
    bool clean;        /**< what is read in this poll may move the target */
    bool connected;
    bool connected_before; /**< the console was connected at least once since the start */

    epg_console_input_t input;
    epg_console_output_t output;
    uint64_t progress_ns; /**< last instant at which the stream accepted bytes, or there were none to send */

    epg_status_t status; /**< newest status */
    bool has_status;

    epg_console_list_t *list;                /**< writer of the present answer of several lines; NULL: there is none */
    const char *list_command;                /**< command that it answers; a string literal */
    size_t list_index;                       /**< next line of the answer */
    size_t list_selected[EPG_CONSOLE_WORDS]; /**< indices of the items in the answer, if they were selected */
    size_t list_count;                       /**< number of `list_selected`; 0: the answer contains all items */

    epg_console_wait_t wait;
    const char *wait_command;
    uint64_t wait_since_ns;
    uint32_t wait_cycles; /**< number of control cycles at the start of the wait */

    bool watching;
    size_t watched[EPG_CONSOLE_WATCHED]; /**< value indices of the watched monitoring values */
    size_t watched_count;
    uint64_t watch_next_ns;  /**< next watch line */
    uint64_t watch_shown_ns; /**< tick of the values in the last watch line */

    bool jogging;
    bool recording;

    epg_console_live_t live;
};

/* console.c ---------------------------------------------------------------------------------------------------- */

/** Begins the line "ok <command>".  The caller may append to it, and must call epg_console_end_or_drop(). */
void epg_console_ok(epg_console_session_t *session, const char *command);

/** Writes the line "ok <command>". */
void epg_console_done(epg_console_session_t *session, const char *command);

/** Writes the line "error <command> <message>".  `about`, if not NULL, follows in quotes. */
void epg_console_error(epg_console_session_t *session, const char *command, const char *message, const char *about);

/** Begins an answer of several lines, which ends with "ok <command>". */
void epg_console_answer(epg_console_session_t *session, const char *command, epg_console_list_t *list);

/** Makes the next command wait for an event. */
void epg_console_wait_for(epg_console_session_t *session, const char *command, epg_console_wait_t wait);

/** Returns true if the stream has found a stop after the bytes that were read last. */
bool epg_console_is_overtaken(const epg_console_session_t *session);

/**
 * Returns true if the present command may move the target.  Otherwise a stop came after it had arrived; the refusal is
 * reported.
 */
bool epg_console_may_move(epg_console_session_t *session, const char *command);

/** Appends the origin of the newest stop, and its number for a program: " stop=9f3c12ab-4 by=line". */
void epg_console_stop(epg_console_session_t *session, const epg_status_t *status);

/** Appends "refused: stopped by ...", the fault if one is latched, and the number of the newest stop. */
void epg_console_refused(epg_console_session_t *session);

/** Appends " fault=" with the name of the fault as one word, and its component. */
void epg_console_fault(epg_console_session_t *session, const epg_status_t *status);

/** Appends " node=" with the node's name, in which "$serial" is replaced. */
void epg_console_node(epg_console_session_t *session);

/** Returns the nanoseconds from the start of the console to the board time `time_ns`. */
uint64_t epg_console_since_start(const epg_console_session_t *session, uint64_t time_ns);

/* input.c ------------------------------------------------------------------------------------------------------ */

/** Takes the bytes that have arrived, up to the end of a line.  Carries out the stops among all of them. */
void epg_console_read(epg_console_session_t *session);

/** Stops the target if a line in an open frame asked for it, and the frame will not become whole. */
void epg_console_poll_scan(epg_console_session_t *session);

/** Takes a byte of a frame, or the zero byte that begins it. */
void epg_console_take_framed(epg_console_session_t *session, uint8_t byte);

/** Drops the line. */
void epg_console_input_clear(epg_console_input_t *input);

/** Splits `line` into words, in place.  Returns false if there are too many. */
bool epg_console_cut(char *line, epg_console_command_t *command);

/** Splits "name=value" in place.  `*value` becomes NULL if there is no "=". */
void epg_console_assignment(char *word, const char **value);

/** Reads a number.  Returns false if `text` is not a number. */
bool epg_console_number(const char *text, double *value);

/** Reads a whole number from 0 to `largest`.  Returns false if `text` is not such a number. */
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

/** Answers a jog that has ended. */
void epg_console_poll_jog(epg_console_session_t *session);

/** Reports a recording that has ended. */
void epg_console_poll_capture(epg_console_session_t *session);

/** Begins a lease, and to send its numbers.  Must be called before the request to enable. */
void epg_console_begin_lease(epg_console_session_t *session);

/**
 * Returns the time until which a movement by hand with `number` may drive, in ns of board time; 0: the number is too old,
 * or was not sent.  Begins to send the numbers of a movement, or goes on to send them.
 */
uint64_t epg_console_may_move_until(epg_console_session_t *session, uint32_t number);

/** Sends rows of the stream, and the number that is due. */
void epg_console_poll_live(epg_console_session_t *session);

/** Ends the connection to a program: no stream, no frames. */
void epg_console_end_frames(epg_console_session_t *session);

/** Writes a watch line if one is due. */
void epg_console_poll_watch(epg_console_session_t *session);

/**
 * Finds a signal by its full name ("inputs.name"), or by "name" if this is unambiguous.  Returns its index, SIZE_MAX if
 * there is none.
 */
size_t epg_console_find_signal(const epg_console_session_t *session, const char *name);

/**
 * Finds a value of `topic` by its name, whose leading slash may be omitted.  Returns its index in the message, SIZE_MAX
 * if there is none.  Only topics with the role EPG_TOPIC_VALUES have values.
 */
size_t epg_console_find_value(const epg_topic_t *topic, const char *name);

#endif
