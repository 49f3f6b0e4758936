/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The command line of a host executable.
 */
#ifndef EPG_HOST_OPTIONS_H
#define EPG_HOST_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct epg_host_options {
    bool help;
    bool interface; /**< only the names that setpoint files may use */
    bool quiet;
    bool realtime;
    bool console;            /**< on standard input and output */
    uint64_t duration_ns;    /**< > 0; UINT64_MAX: until it is ended */
    const char *agent;       /**< HOST:PORT; NULL: as generated */
    const char *device;      /**< terminal that the agent is on, instead; NULL: none was given */
    const char *console_pty; /**< name of the terminal that the console is on; NULL: none */
    const char *store;       /**< path of the file that stored values are in; NULL: none */
    const char *serial;      /**< word that stands for "$serial" in names; NULL: none was given */
    const char *setpoints;   /**< path to read; NULL: none */
    const char *topics;      /**< paths to write; NULL: not written */
    const char *trace;
    const char *statistics;
} epg_host_options_t;

/**
 * Reads the command line of a target whose middleware is `connected` by itself or not; false after a message to stderr
 * that says what is wrong.
 */
bool epg_host_read_options(int argc, char **argv, bool connected, epg_host_options_t *options);

/** The rest of that, when all options but `duration` (NULL: not given) are in `options`: whether they go together. */
bool epg_host_complete_options(const char *duration, bool connected, epg_host_options_t *options);

/** Prints how the program is used. */
void epg_host_print_help(const char *name);

#endif
