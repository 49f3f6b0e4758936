/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The output of the console: a ring of bytes for lines that are not yet sent.
 */
#include "output.h"

#include <string.h>

#include "epg/decimal.h"
#include "frame.h"

void epg_console_output_clear(epg_console_output_t *output)
{
    output->begin = 0;
    output->used = 0;
    output->writing = 0;
    output->full = false;
    output->in_frame = false;
}

size_t epg_console_output_room(const epg_console_output_t *output)
{
    return output->size - output->used;
}

/** Writes a byte of the unfinished line or frame at `place`, in bytes after the complete lines. */
static void set(epg_console_output_t *output, size_t place, char byte)
{
    const size_t index = output->begin + output->used + place;
    output->bytes[index < output->size ? index : index - output->size] = byte;
}

static void put(epg_console_output_t *output, char byte)
{
    if (output->writing == epg_console_output_room(output)) {
        output->full = true;
    } else {
        set(output, output->writing++, byte);
    }
}

/** Ends a run of COBS with its code, and begins the next one. */
static void next_run(epg_console_output_t *output)
{
    if (!output->full) {
        set(output, output->code_at, (char)output->run);
    }
    output->code_at = output->writing;
    output->run = 1;
    put(output, 0);
}

static void encode(epg_console_output_t *output, uint8_t byte)
{
    output->crc = epg_console_crc(output->crc, byte);
    if (byte != 0) {
        put(output, (char)byte);
        output->run++;
    }
    if (byte == 0 || output->run == EPG_CONSOLE_FRAME_RUN) {
        next_run(output);
    }
}

void epg_console_begin_frame(epg_console_output_t *output, char type)
{
    output->writing = 0;
    output->full = false;
    output->in_frame = true;
    output->crc = EPG_CONSOLE_CRC_START;
    put(output, 0);
    output->code_at = output->writing;
    output->run = 1;
    put(output, 0);
    encode(output, (uint8_t)type);
}

void epg_console_whole_number(epg_console_output_t *output, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++) {
        encode(output, (uint8_t)(value >> 8U * i));
    }
}

static void end_frame(epg_console_output_t *output)
{
    epg_console_whole_number(output, output->crc ^ EPG_CONSOLE_CRC_START, EPG_CONSOLE_FRAME_CRC);
    if (!output->full) {
        set(output, output->code_at, (char)output->run);
    }
    put(output, 0);
    output->in_frame = false;
}

void epg_console_begin(epg_console_output_t *output, const char *first)
{
    output->writing = 0;
    output->full = false;
    output->in_frame = false;
    if (output->framed) {
        epg_console_begin_frame(output, EPG_CONSOLE_ANSWER);
        epg_console_whole_number(output, output->tag, 1);
    }
    epg_console_text(output, first);
}

void epg_console_bytes(epg_console_output_t *output, const char *text, size_t length)
{
    for (size_t i = 0; i < length && !output->full; i++) {
        if (output->in_frame) {
            encode(output, (uint8_t)text[i]);
        } else {
            put(output, text[i]);
        }
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
    if (output->in_frame) {
        end_frame(output);
    } else {
        epg_console_text(output, "\r\n"); /* a plain serial terminal needs both characters */
    }
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
    if (output->framed) {
        return;
    }
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
