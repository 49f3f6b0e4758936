/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middleware `console`: commands and answers as lines of text, for users at a terminal and for programs.
 * docs/console.md defines them.
 *
 * An executable can contain one console.  It does not need a heap, never waits, and does a bounded amount of work per
 * poll: it reads at most 64 bytes, carries out at most one command and writes at most four lines of an answer.
 */
#ifndef EPG_CONSOLE_H
#define EPG_CONSOLE_H

#include <stddef.h>
#include <stdint.h>

#include "epg/middleware.h"

/** The options of a console.  The generator defines the arrays. */
typedef struct epg_console_options {
    char *output; /**< `output_size` bytes: room for answers that are not yet sent */
    size_t output_size;
    uint32_t transport_rate; /**< bytes per second that the transport carries; 0: more than a stream can need */
    double *values;          /**< room for all monitoring values */
    double jog_duty;         /**< largest magnitude of the duty of `jog` */
    uint64_t jog_time_ns;    /**< longest time of `jog` */
} epg_console_options_t;

extern const epg_middleware_t epg_console;

#endif
