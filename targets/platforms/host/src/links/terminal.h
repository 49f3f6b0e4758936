/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams between a middleware and the user at the computer: standard input and output, or a pseudo-terminal.
 *
 * A pseudo-terminal looks to other programs like the serial port of a board.
 *
 * Windows has no pseudo-terminals.  Only one thread may use a terminal.
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
    bool own;         /**< true: a pseudo-terminal; false: standard input and output */
    bool opened;      /**< at the last look, a program had the other end of the pseudo-terminal open */
    const char *path; /**< symbolic link to the pseudo-terminal, which is removed at the end; NULL: none */
    bool lost;        /**< the reader of the output has gone */
    uint64_t end_ns;  /**< monotonic time at which standard input ended; 0: it has not ended */
} epg_host_terminal_t;

/** Opens standard input and output. */
void epg_host_terminal_standard(epg_host_terminal_t *terminal);

/**
 * Makes a pseudo-terminal, and `path` as a symbolic link to it, which epg_host_terminal_close() removes.  Returns
 * false, with a message, if this fails.
 */
bool epg_host_terminal_open(epg_host_terminal_t *terminal, const char *path);

/**
 * True if it makes sense to wait for input.  False if standard input has ended, or no program has the pseudo-terminal
 * open:  poll() would then return at once.
 */
bool epg_host_terminal_listens(const epg_host_terminal_t *terminal);

/** True if standard input has ended 0.2 s ago or earlier, so that the last commands could be answered. */
bool epg_host_terminal_ended(const epg_host_terminal_t *terminal, uint64_t now_ns);

void epg_host_terminal_close(epg_host_terminal_t *terminal);

#endif
