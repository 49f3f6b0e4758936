/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The console: a target by lines of text, for people at a terminal and for programs.  docs/console.md defines it.
 *
 * There is one console in an executable.  It needs no heap, never waits, and does a bounded amount of work per poll:
 * it reads at most 64 bytes, carries out at most one command and writes at most four lines.
 */
#ifndef EPG_CONSOLE_H
#define EPG_CONSOLE_H

#include <stddef.h>
#include <stdint.h>

#include "epg/middleware.h"

/** What a generated target gives to its console; the arrays are the generator's. */
typedef struct epg_console_options {
    char *output; /**< `output_size`: answers that wait to be read */
    size_t output_size;
    double *values;       /**< room for the monitoring values */
    double jog_duty;      /**< largest size of a duty */
    uint64_t jog_time_ns; /**< longest time */
} epg_console_options_t;

extern const epg_middleware_t epg_console;

#endif
