/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Received lines and their words.  The input can be any sequence of bytes.
 */
#include <string.h>

#include "epg/decimal.h"
#include "session.h"

enum {
    END_OF_TEXT = 3,
    BACKSPACE = 8,
    DELETE = 127,
    HELD_MS = 20, /* an open frame in which no byte arrives for this time will not become whole */
    MS = 1000000  /* ns */
};

void epg_console_input_clear(epg_console_input_t *input)
{
    input->length = 0;
    input->too_long = false;
    input->no_text = false;
    input->tag = 0;
    input->complete = false;
    input->may_move = false;
    input->stopped = false;
    input->is_stop = false;
}

static void echo(epg_console_session_t *session, const char *text, size_t length)
{
    if (session->input.echo) {
        epg_console_raw(&session->output, text, length);
    }
}

/** Appends a character to the line. */
static void append(epg_console_session_t *session, char character)
{
    epg_console_input_t *input = &session->input;
    const unsigned char code = (unsigned char)character;
    if ((code < ' ' && code != '\t') || code > DELETE) {
        input->no_text = true;
    } else if (input->length == EPG_CONSOLE_LINE) {
        input->too_long = true;
    } else {
        input->line[input->length++] = character;
        echo(session, &character, 1);
    }
}

static void take(epg_console_session_t *session, char byte)
{
    epg_console_input_t *input = &session->input;
    if (byte == '\0' || session->live.frame.open) {
        epg_console_take_framed(session, (uint8_t)byte);
        return;
    }
    switch (byte) {
    case '\r':
    case '\n':
        input->complete = input->length > 0 || input->too_long || input->no_text;
        echo(session, "\r\n", byte == '\r' || input->complete ? 2 : 0);
        break;
    case END_OF_TEXT:
        epg_console_input_clear(input);
        session->list = NULL;
        session->watching = false;
        break;
    case BACKSPACE:
    case DELETE:
        if (input->length > 0) {
            input->length--;
            echo(session, "\b \b", 3);
        }
        break;
    default:
        append(session, byte);
        break;
    }
}

static void stop(epg_console_session_t *session, epg_console_found_t found)
{
    session->input.may_move = false;          /* of a line that waits: it arrived before */
    if (session->stream->overtaken == NULL) { /* otherwise the stream has done so */
        epg_stop(session->target->control, found == EPG_CONSOLE_FOUND_FRAME ? EPG_STOP_FRAME : EPG_STOP_LINE);
    }
}

/** Searches the bytes of the chunk from `begin` on for stops. */
static void scan_chunk(epg_console_session_t *session, size_t begin)
{
    epg_console_input_t *input = &session->input;
    for (size_t i = begin; i < input->chunk_length; i++) {
        const epg_console_found_t found = epg_console_scan(&input->scan, (uint8_t)input->chunk[i]);
        if (found != EPG_CONSOLE_FOUND_NOTHING) {
            stop(session, found);
            input->stop_position = i + 1;
        }
    }
}

/** Moves the bytes that wait to the beginning of the chunk. */
static void drop_taken(epg_console_input_t *input)
{
    const size_t taken = input->chunk_position;
    input->chunk_length -= taken;
    input->stop_position = input->stop_position > taken ? input->stop_position - taken : 0;
    input->clean_position = input->clean_position > taken ? input->clean_position - taken : 0;
    input->chunk_position = 0;
    (void)memmove(input->chunk, input->chunk + taken, input->chunk_length);
}

/** Reads bytes and searches them for stops, also while a command waits.  Datagrams are read one by one. */
static void read_more(epg_console_session_t *session)
{
    epg_console_input_t *input = &session->input;
    const epg_stream_t *stream = session->stream;
    const bool one_by_one = stream->datagrams || stream->overtaken != NULL;
    if (one_by_one && input->chunk_position < input->chunk_length) {
        return;
    }
    drop_taken(input);
    const size_t begin = input->chunk_length;
    const size_t room = sizeof input->chunk - begin;
    if (room == 0) {
        return;
    }
    const size_t size = room < EPG_CONSOLE_READ ? room : EPG_CONSOLE_READ;
    input->chunk_length += stream->read(stream->context, input->chunk + begin, size);
    if (input->chunk_length > begin) {
        input->byte_ns = session->now_ns;
        scan_chunk(session, begin);
    }
}

void epg_console_read(epg_console_session_t *session)
{
    epg_console_input_t *input = &session->input;
    if (!session->clean || epg_console_is_overtaken(session)) { /* a stop came while the line waited */
        input->may_move = false;
    }
    read_more(session);
    if (!session->clean) { /* since the last poll; bytes that were read now can have arrived before it */
        input->clean_position = input->chunk_length;
    }
    while (input->chunk_position < input->chunk_length && !input->complete) {
        take(session, input->chunk[input->chunk_position++]);
        if (input->complete) {
            input->may_move =
                input->chunk_position > input->clean_position && input->chunk_position >= input->stop_position;
            input->stopped = input->chunk_position <= input->stop_position;
            input->is_stop = input->chunk_position == input->stop_position;
        }
    }
}

void epg_console_poll_scan(epg_console_session_t *session)
{
    epg_console_input_t *input = &session->input;
    if (input->scan.frame.open && session->now_ns - input->byte_ns > (uint64_t)HELD_MS * MS) {
        if (epg_console_scan_end_frame(&input->scan)) {
            stop(session, EPG_CONSOLE_FOUND_LINE);
            input->clean_position = input->chunk_length;
        }
    }
}

bool epg_console_cut(char *line, epg_console_command_t *command)
{
    command->count = 0;
    char *next = line;
    for (;;) {
        while (*next == ' ' || *next == '\t') {
            next++;
        }
        if (*next == '\0') {
            return true;
        }
        if (command->count == EPG_CONSOLE_WORDS) {
            return false;
        }
        command->words[command->count++] = next;
        while (*next != ' ' && *next != '\t' && *next != '\0') {
            next++;
        }
        if (*next != '\0') {
            *next++ = '\0';
        }
    }
}

void epg_console_assignment(char *word, const char **value)
{
    char *sign = strchr(word, '=');
    *value = NULL;
    if (sign != NULL) {
        *sign = '\0';
        *value = sign + 1;
    }
}

bool epg_console_number(const char *text, double *value)
{
    return epg_decimal_read(text, value);
}

bool epg_console_whole(const char *text, uint32_t largest, uint32_t *value)
{
    uint64_t number = 0;
    for (size_t i = 0; text[i] != '\0'; i++) {
        if (text[i] < '0' || text[i] > '9') {
            return false;
        }
        number = number * 10U + (uint64_t)(text[i] - '0');
        if (number > largest) {
            return false;
        }
    }
    *value = (uint32_t)number;
    return text[0] != '\0';
}
