/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The search for stops.
 */
#include "scan.h"

#include <string.h>

static const char word[] = "disable";

/** States of the search in a line: 0 ... LENGTH characters of the word have matched, or one of these. */
enum { LENGTH = sizeof word - 1, STOP, OTHER };

/** Takes a byte of a line.  Returns true if it ends a line that is a stop. */
static bool match(epg_console_scan_t *scan, uint8_t byte)
{
    const bool ends = byte == '\n' || byte == '\r';
    const bool blank = byte == ' ' || byte == '\t';
    const bool whole = scan->matched == LENGTH || scan->matched == STOP;
    if (ends) {
        scan->matched = 0;
        return whole;
    }
    if (whole) {
        scan->matched = scan->matched == STOP || blank ? STOP : OTHER;
    } else if (scan->matched < LENGTH && byte == (uint8_t)word[scan->matched]) {
        scan->matched++;
    } else if (scan->matched != 0 || !blank) {
        scan->matched = OTHER;
    }
    return false;
}

static bool is_stop(const epg_console_scan_t *scan)
{
    return scan->frame.length >= 2 + LENGTH && scan->bytes[0] == EPG_CONSOLE_COMMAND &&
           memcmp(scan->bytes + 2, word, LENGTH) == 0;
}

epg_console_found_t epg_console_scan(epg_console_scan_t *scan, uint8_t byte)
{
    if (byte != 0 && !scan->frame.open) {
        return match(scan, byte) ? EPG_CONSOLE_FOUND_LINE : EPG_CONSOLE_FOUND_NOTHING;
    }
    if (byte != 0) {
        scan->held = match(scan, byte) || scan->held;
    } else {
        scan->matched = 0;
    }
    const bool held = scan->held;
    switch (epg_console_frame_take(&scan->frame, scan->bytes, sizeof scan->bytes, byte)) {
    case EPG_CONSOLE_FRAME_WHOLE:
        scan->held = false;
        return is_stop(scan) ? EPG_CONSOLE_FOUND_FRAME : EPG_CONSOLE_FOUND_NOTHING;
    case EPG_CONSOLE_FRAME_TOO_LONG:
        scan->held = false;
        return EPG_CONSOLE_FOUND_NOTHING;
    case EPG_CONSOLE_FRAME_DAMAGED:
        scan->held = false;
        return held ? EPG_CONSOLE_FOUND_LINE : EPG_CONSOLE_FOUND_NOTHING;
    case EPG_CONSOLE_FRAME_MORE:
        break;
    }
    return EPG_CONSOLE_FOUND_NOTHING;
}

bool epg_console_scan_end_frame(epg_console_scan_t *scan)
{
    const bool held = scan->held;
    scan->held = false;
    scan->frame = (epg_console_frame_t){0};
    return held;
}

void epg_console_scan_begin_line(epg_console_scan_t *scan)
{
    scan->matched = 0;
}
