/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The command line of a host executable.
 */
#ifndef EPG_HOST_OPTIONS_H
#define EPG_HOST_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "ros/ros_arguments.h"

/** Exit status of the program. */
enum { DONE = 0, FAILED = 1, WRONG_INPUT = 2, INTERRUPTED = 130 };

typedef struct epg_host_options {
    bool help;
    bool interface; /**< prints the names that setpoint files may use, and does not run the target */
    bool quiet;
    bool realtime;
    bool console;            /**< on standard input and output */
    uint64_t duration_ns;    /**< > 0; UINT64_MAX: until the user ends the run */
    double pace;             /**< simulated time at this multiple of real time, with a connection; 0: not given */
    const char *agent;       /**< address of the agent, HOST:PORT; NULL: the generated one */
    const char *device;      /**< path of the agent's terminal, in place of an address; NULL: not given */
    const char *console_pty; /**< name of the console's terminal; NULL: none */
    const char *console_udp; /**< address of the console's socket, [ADDRESS:]PORT; NULL: none */
    const char *console_key; /**< path of the file with the key of this socket; NULL: not given */
    bool console_open;       /**< the socket needs no key, on any address */
    const char *store;       /**< path of the file for stored values; NULL: none */
    const char *serial;      /**< word that replaces "$serial" in names; NULL: not given */
    const char *setpoints;   /**< path of the setpoint file; NULL: none */
    const char *topics;      /**< path of the file for publications; NULL: not written */
    const char *trace;       /**< path of the file for signals; NULL: not written */
    const char *replay;      /**< path of the recording to replay; NULL: a run */
    const char *statistics;  /**< path of the file for statistics; NULL: not written */
    epg_host_ros_t ros;      /**< the arguments after --ros-args */
} epg_host_options_t;

/**
 * Reads the command line.  `connected` is true if the target's middleware has a connection other than a terminal.
 * Returns false after a message to stderr that describes the mistake.
 */
bool epg_host_read_options(int argc, char **argv, bool connected, epg_host_options_t *options);

/** True if a run with these options connects to the target's middleware. */
static inline bool epg_host_connects(const epg_host_options_t *options)
{
    return options->realtime || options->pace > 0.0;
}

/** True if a run with these options has a console. */
static inline bool epg_host_has_console(const epg_host_options_t *options)
{
    return options->console || options->console_pty != NULL || options->console_udp != NULL;
}

/**
 * The second half of epg_host_read_options(): checks if the options can be combined, and reads `duration` (NULL: not
 * given).  Returns false after a message.
 */
bool epg_host_complete_options(const char *duration, bool connected, epg_host_options_t *options);

/** Prints the usage of the program. */
void epg_host_print_help(const char *name);

#endif
