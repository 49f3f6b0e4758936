/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams between a middleware and whoever sits at the computer: standard input and output, or a terminal of its own.
 *
 * Linux only, as real time is.  For one thread.
 */
#ifndef EPG_HOST_TERMINAL_H
#define EPG_HOST_TERMINAL_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/stream.h"

typedef struct epg_host_terminal {
    epg_stream_t stream;
    int input;
    int output;
    bool own;         /**< a pseudo-terminal, whose name in the file system is `path` */
    const char *path; /**< NULL when there is none to remove */
    bool lost;        /**< nobody will read any more */
    uint64_t end_ns;  /**< monotonic time at which standard input ended; 0: it has not */
} epg_host_terminal_t;

/** Standard input and output. */
void epg_host_terminal_standard(epg_host_terminal_t *terminal);

/** A pseudo-terminal with the name `path`, a link that is removed at the end; false, with a message, if there is none. */
bool epg_host_terminal_open(epg_host_terminal_t *terminal, const char *path);

/** Whether input can still come: a terminal that nobody has open, and input that has ended, are always ready. */
bool epg_host_terminal_listens(const epg_host_terminal_t *terminal);

/** True when standard input has ended, and what was read before has had time to be answered. */
bool epg_host_terminal_ended(const epg_host_terminal_t *terminal, uint64_t now_ns);

void epg_host_terminal_close(epg_host_terminal_t *terminal);

#endif
