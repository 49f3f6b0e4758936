/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Numbers in the form of the host's files.
 */
#ifndef EPG_HOST_NUMBER_H
#define EPG_HOST_NUMBER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/** The longest time that the host accepts, in seconds: 30 years.  It is far below the range of 64-bit nanoseconds. */
#define EPG_HOST_TIME_MAX 1e9

/** Reads a decimal number, "nan", "inf" or "-inf".  Returns false if `text` as a whole is not one of these. */
bool epg_host_parse_number(const char *text, double *value);

/**
 * Reads a time in seconds, 0 ... EPG_HOST_TIME_MAX, and converts it to nanoseconds.  Returns false if it is not one.
 */
bool epg_host_parse_time(const char *text, uint64_t *time_ns);

/** Writes `value` with the fewest digits that give the same double when read again, or "nan", "inf" or "-inf". */
void epg_host_write_number(FILE *file, double value);

/** Converts nanoseconds to seconds, for files and messages. */
static inline double epg_host_seconds(uint64_t time_ns)
{
    return (double)time_ns / 1e9;
}

#endif
