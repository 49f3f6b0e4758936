/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Lines that wait to be read: a ring of bytes that takes a line whole or not at all.
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
    size_t begin;     /**< of what waits */
    size_t used;      /**< bytes of whole lines */
    size_t writing;   /**< bytes of the line that is being written, behind them */
    bool full;        /**< that line does not fit */
    uint32_t dropped; /**< lines that found no room */
} epg_console_output_t;

/** Makes it empty; `bytes` and `size` stay. */
void epg_console_output_clear(epg_console_output_t *output);

/** Free bytes. */
size_t epg_console_output_room(const epg_console_output_t *output);

/** Begins a line with the word `first`, instead of one that has been begun and not ended. */
void epg_console_begin(epg_console_output_t *output, const char *first);

void epg_console_text(epg_console_output_t *output, const char *text);
void epg_console_bytes(epg_console_output_t *output, const char *text, size_t length);
void epg_console_double(epg_console_output_t *output, double value);
void epg_console_integer(epg_console_output_t *output, int64_t value);
void epg_console_seconds(epg_console_output_t *output, uint64_t time_ns);

/** " name=", before a value. */
void epg_console_key(epg_console_output_t *output, const char *name);

/** " name=value" of a whole number. */
void epg_console_count(epg_console_output_t *output, const char *name, uint32_t value);

/** Ends the line.  False if it did not fit: then nothing of it is left. */
bool epg_console_end(epg_console_output_t *output);

/** As epg_console_end(), for a line that nobody waits for: one that does not fit is counted as dropped. */
void epg_console_end_or_drop(epg_console_output_t *output);

/** Adds bytes that are no line, if there is room. */
void epg_console_raw(epg_console_output_t *output, const char *bytes, size_t length);

/** Hands over what the stream takes; true if it took anything. */
bool epg_console_send(epg_console_output_t *output, const epg_stream_t *stream);

#endif
