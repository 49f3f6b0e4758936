/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Numbers as the host's files hold them.
 */
#ifndef EPG_HOST_NUMBER_H
#define EPG_HOST_NUMBER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/** Largest time the host accepts, in seconds: 30 years, far below the range of its 64-bit nanoseconds. */
#define EPG_HOST_TIME_MAX 1e9

/** Reads a decimal number, "nan", "inf" or "-inf" that fills the whole of `text`; false when it is none. */
bool epg_host_parse_number(const char *text, double *value);

/** Reads a time in seconds, 0 ... EPG_HOST_TIME_MAX, as nanoseconds; false when it is none. */
bool epg_host_parse_time(const char *text, uint64_t *time_ns);

/** Writes `value` with as few digits as give the same double when read again; "nan", "inf" or "-inf". */
void epg_host_write_number(FILE *file, double value);

/** Seconds, for files and messages. */
static inline double epg_host_seconds(uint64_t time_ns)
{
    return (double)time_ns / 1e9;
}

#endif
