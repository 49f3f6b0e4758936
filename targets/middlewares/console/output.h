/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The output of the console: a ring of bytes for lines that are not yet sent.
 *
 * A line is built piece by piece, after the complete lines.  It is kept completely or not at all.  While the other end
 * uses frames (frame.h), each line is sent as the text of a frame, and frames with other messages are built like lines.
 */
#ifndef EPG_CONSOLE_OUTPUT_H
#define EPG_CONSOLE_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/stream.h"

typedef struct epg_console_output {
    char *bytes;
    size_t size;
    size_t begin;     /**< index of the first byte to send */
    size_t used;      /**< bytes of complete lines */
    size_t writing;   /**< bytes of the unfinished line or frame after them */
    bool full;        /**< the unfinished line or frame does not fit */
    bool framed;      /**< lines are sent in frames */
    uint8_t tag;      /**< of the frames of lines: number of the command that the line answers; 0: none */
    bool in_frame;    /**< a frame is unfinished */
    size_t code_at;   /**< place of the unfinished frame's last code, in bytes after `used` */
    uint8_t run;      /**< that code so far */
    uint32_t crc;     /**< CRC of the unfinished frame's message so far */
    uint32_t dropped; /**< number of lines for which there was no room */
} epg_console_output_t;

/** Removes all lines; `bytes` and `size` stay. */
void epg_console_output_clear(epg_console_output_t *output);

/** Returns the number of free bytes. */
size_t epg_console_output_room(const epg_console_output_t *output);

/** Begins a frame with the message type `type`. */
void epg_console_begin_frame(epg_console_output_t *output, char type);

/** Appends the lowest `bytes` bytes of a whole number to the unfinished frame, least significant byte first. */
void epg_console_whole_number(epg_console_output_t *output, uint64_t value, size_t bytes);

/** Begins a line with the word `first`.  Drops an unfinished line. */
void epg_console_begin(epg_console_output_t *output, const char *first);

/* These functions append to the unfinished line: a text, bytes, a number, a time in seconds. */
void epg_console_text(epg_console_output_t *output, const char *text);
void epg_console_bytes(epg_console_output_t *output, const char *text, size_t length);
void epg_console_double(epg_console_output_t *output, double value);
void epg_console_integer(epg_console_output_t *output, int64_t value);
void epg_console_seconds(epg_console_output_t *output, uint64_t time_ns);

/** Appends " name=", the start of a value. */
void epg_console_key(epg_console_output_t *output, const char *name);

/** Appends " name=word". */
void epg_console_word(epg_console_output_t *output, const char *name, const char *word);

/** Appends " unit=" and the unit; nothing if the unit is empty. */
void epg_console_unit(epg_console_output_t *output, const char *unit);

/** Appends " name=value". */
void epg_console_value(epg_console_output_t *output, const char *name, double value);

/** Appends " name=value" for a whole number. */
void epg_console_count(epg_console_output_t *output, const char *name, uint32_t value);

/** Ends the line or frame.  Returns false if it did not fit; it is removed then. */
bool epg_console_end(epg_console_output_t *output);

/** As epg_console_end(), but counts a line that does not fit as dropped, because it is not written again. */
void epg_console_end_or_drop(epg_console_output_t *output);

/** Appends bytes that are not a line, if there is room, and if lines are not sent in frames. */
void epg_console_raw(epg_console_output_t *output, const char *bytes, size_t length);

/** Passes bytes to the stream, as many as it accepts.  Returns true if it accepted at least one. */
bool epg_console_send(epg_console_output_t *output, const epg_stream_t *stream);

#endif
