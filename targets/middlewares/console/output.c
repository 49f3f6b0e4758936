/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The output of the console: a ring of bytes for lines that are not yet sent.
 */
#include "output.h"

#include <string.h>

#include "epg/decimal.h"

void epg_console_output_clear(epg_console_output_t *output)
{
    output->begin = 0;
    output->used = 0;
    output->writing = 0;
    output->full = false;
}

size_t epg_console_output_room(const epg_console_output_t *output)
{
    return output->size - output->used;
}

void epg_console_begin(epg_console_output_t *output, const char *first)
{
    output->writing = 0;
    output->full = false;
    epg_console_text(output, first);
}

void epg_console_bytes(epg_console_output_t *output, const char *text, size_t length)
{
    if (length > output->size - output->used - output->writing) {
        output->full = true;
        return;
    }
    for (size_t i = 0; i < length; i++) {
        const size_t place = output->begin + output->used + output->writing;
        output->bytes[place < output->size ? place : place - output->size] = text[i];
        output->writing++;
    }
}

void epg_console_text(epg_console_output_t *output, const char *text)
{
    epg_console_bytes(output, text, strlen(text));
}

void epg_console_double(epg_console_output_t *output, double value)
{
    char text[EPG_DECIMAL_SIZE];
    epg_console_bytes(output, text, epg_decimal_write(text, value));
}

void epg_console_integer(epg_console_output_t *output, int64_t value)
{
    char text[EPG_DECIMAL_SIZE];
    epg_console_bytes(output, text, epg_decimal_write_integer(text, value));
}

void epg_console_seconds(epg_console_output_t *output, uint64_t time_ns)
{
    char text[EPG_DECIMAL_SIZE];
    epg_console_bytes(output, text, epg_decimal_write_seconds(text, time_ns));
}

void epg_console_key(epg_console_output_t *output, const char *name)
{
    epg_console_text(output, " ");
    epg_console_text(output, name);
    epg_console_text(output, "=");
}

void epg_console_word(epg_console_output_t *output, const char *name, const char *word)
{
    epg_console_key(output, name);
    epg_console_text(output, word);
}

void epg_console_unit(epg_console_output_t *output, const char *unit)
{
    if (unit[0] != '\0') {
        epg_console_word(output, "unit", unit);
    }
}

void epg_console_value(epg_console_output_t *output, const char *name, double value)
{
    epg_console_key(output, name);
    epg_console_double(output, value);
}

void epg_console_count(epg_console_output_t *output, const char *name, uint32_t value)
{
    epg_console_key(output, name);
    epg_console_integer(output, value);
}

bool epg_console_end(epg_console_output_t *output)
{
    epg_console_text(output, "\r\n"); /* a plain serial terminal needs both characters */
    const bool whole = !output->full;
    output->used += whole ? output->writing : 0U;
    output->writing = 0;
    output->full = false;
    return whole;
}

void epg_console_end_or_drop(epg_console_output_t *output)
{
    if (!epg_console_end(output)) {
        output->dropped++;
    }
}

void epg_console_raw(epg_console_output_t *output, const char *bytes, size_t length)
{
    epg_console_begin(output, "");
    epg_console_bytes(output, bytes, length);
    output->used += output->full ? 0U : output->writing;
    output->writing = 0;
    output->full = false;
}

bool epg_console_send(epg_console_output_t *output, const epg_stream_t *stream)
{
    bool sent = false;
    /* At most two parts: up to the end of the ring, then from its start. */
    for (int part = 0; part < 2 && output->used > 0; part++) {
        const size_t length = output->begin + output->used > output->size ? output->size - output->begin : output->used;
        const size_t taken = stream->write(stream->context, output->bytes + output->begin, length);
        output->begin = output->begin + taken == output->size ? 0U : output->begin + taken;
        output->used -= taken;
        sent = sent || taken > 0;
        if (taken < length) {
            break;
        }
    }
    return sent;
}
