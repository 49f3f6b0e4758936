/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Received lines and their words.  The input can be any sequence of bytes.
 */
#include <string.h>

#include "epg/decimal.h"
#include "session.h"

enum { END_OF_TEXT = 3, BACKSPACE = 8, DELETE = 127 };

void epg_console_input_clear(epg_console_input_t *input)
{
    input->length = 0;
    input->too_long = false;
    input->no_text = false;
    input->tag = 0;
    input->complete = false;
}

static void echo(epg_console_session_t *session, const char *text, size_t length)
{
    if (session->input.echo) {
        epg_console_raw(&session->output, text, length);
    }
}

static void take(epg_console_session_t *session, char byte)
{
    epg_console_input_t *input = &session->input;
    const unsigned char code = (unsigned char)byte;
    if (code == 0 || session->live.frame.open) {
        epg_console_take_framed(session, code);
    } else if (byte == '\r' || byte == '\n') {
        input->complete = input->length > 0 || input->too_long || input->no_text;
        echo(session, "\r\n", byte == '\r' || input->complete ? 2 : 0);
    } else if (code == END_OF_TEXT) {
        epg_console_input_clear(input);
        session->list = NULL;
        session->watching = false;
    } else if (code == BACKSPACE || code == DELETE) {
        if (input->length > 0) {
            input->length--;
            echo(session, "\b \b", 3);
        }
    } else if ((code < ' ' && byte != '\t') || code > DELETE) {
        input->no_text = true;
    } else if (input->length == EPG_CONSOLE_LINE) {
        input->too_long = true;
    } else {
        input->line[input->length++] = byte;
        echo(session, &byte, 1);
    }
}

void epg_console_read(epg_console_session_t *session)
{
    epg_console_input_t *input = &session->input;
    if (input->chunk_position == input->chunk_length) {
        input->chunk_position = 0;
        input->chunk_length = session->stream->read(session->stream->context, input->chunk, sizeof input->chunk);
    }
    while (input->chunk_position < input->chunk_length && !input->complete) {
        take(session, input->chunk[input->chunk_position++]);
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
