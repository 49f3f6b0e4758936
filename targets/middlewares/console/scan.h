/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The search for stops in bytes that were received, before any command acts.
 *
 * Commands wait for the answers before them.  A stop must not: each byte passes this search as soon as it is read.  A
 * stop is a line whose first word is `disable`, or a frame with this command.
 *
 * One zero byte, such as noise of a plug, opens a frame, and what follows up to the next zero byte belongs to it.  A
 * line `disable` in an open frame is therefore *held*: it stops the target unless the frame proves whole.
 */
#ifndef EPG_CONSOLE_SCAN_H
#define EPG_CONSOLE_SCAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "frame.h"

enum { EPG_CONSOLE_SCAN_FRAME = 2 + 7 + EPG_CONSOLE_FRAME_CRC }; /* type, tag, "disable" */

/** A search.  All zero is its beginning. */
typedef struct epg_console_scan {
    uint8_t matched;           /**< state of the search in the present line */
    bool held;                 /**< a line in the open frame is a stop */
    epg_console_frame_t frame; /**< the open frame */
    uint8_t bytes[EPG_CONSOLE_SCAN_FRAME];
} epg_console_scan_t;

/** The meaning of a byte for the search. */
typedef enum epg_console_found {
    EPG_CONSOLE_FOUND_NOTHING,
    EPG_CONSOLE_FOUND_LINE, /**< a line is a stop, or a frame with such a line is damaged */
    EPG_CONSOLE_FOUND_FRAME /**< a frame is a stop */
} epg_console_found_t;

/** Takes the next byte. */
epg_console_found_t epg_console_scan(epg_console_scan_t *scan, uint8_t byte);

/** Ends an open frame in which no byte has arrived for a while.  Returns true if a line in it is a stop. */
bool epg_console_scan_end_frame(epg_console_scan_t *scan);

/** Lets the next byte begin a line, because another program may send it. */
void epg_console_scan_begin_line(epg_console_scan_t *scan);

#endif
