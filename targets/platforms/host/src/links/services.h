/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middlewares that run beside the control loop in real time: the target's middleware, and its console.
 *
 * The target's middleware makes its own connection, or has a link to an agent, or uses the terminal or UDP socket of a
 * console.  In the first two cases the terminal or socket is free for a console.
 */
#ifndef EPG_HOST_SERVICES_H
#define EPG_HOST_SERVICES_H

#include <stdbool.h>
#include <stdint.h>

#include "link.h"
#include "program/options.h"
#include "terminal.h"
#include "udp_console.h"

#include "epg/host.h"
#include "epg/middleware.h"

typedef struct epg_host_services {
    const epg_target_t *target;
    epg_host_link_t *link;         /**< link to the agent of the target's middleware; NULL: no agent */
    const char *agent;             /**< address of the agent; NULL: no agent */
    bool quiet;                    /**< the first connection is not told */
    const char *state;             /**< state of the connection at the last message; NULL: not connected */
    epg_host_terminal_t *terminal; /**< NULL: no terminal */
    epg_host_udp_console_t *udp;   /**< NULL: no console by UDP */
} epg_host_services_t;

/** True if the target's middleware makes its own connection. */
bool epg_host_connects_itself(const epg_target_t *target);

/** True if the target's middleware has a connection other than a terminal. */
bool epg_host_is_connected(const epg_host_target_t *host);

/** The middleware that would be the console; NULL if none would. */
const epg_middleware_t *epg_host_console(const epg_host_target_t *host);

/**
 * Opens the link to the agent, if the target has an agent and the run is in real time, and the terminal or socket of the
 * console, if `options` request one.  Returns DONE, or after a message the exit status.  Only one object can be open.
 */
int epg_host_services_open(epg_host_services_t *services, const epg_host_target_t *host,
                           const epg_host_options_t *options);

/**
 * Gives the session with the agent a key that no other program has.  Returns DONE, or FAILED after a message if another
 * copy of this program has the same name and agent.  The names of the target are final.
 */
int epg_host_services_identify(const epg_host_services_t *services);

void epg_host_services_close(epg_host_services_t *services);

/** Reports on stderr that the connection to the agent was made or lost. */
void epg_host_services_tell(epg_host_services_t *services);

/** True if at least one middleware runs. */
bool epg_host_services_run(const epg_host_services_t *services);

void epg_host_services_start(const epg_host_services_t *services);

/**
 * Sleeps until monotonic time `time_ns`, until bytes arrive, or for a millisecond, whichever is first.  Then serves all
 * middlewares.  Reports on stderr when the connection to an agent was made or lost.
 */
void epg_host_services_serve(epg_host_services_t *services, uint64_t time_ns);

/** Sleeps until monotonic time `time_ns`, or until bytes arrive at the link or the console. */
void epg_host_services_wait(const epg_host_services_t *services, uint64_t time_ns);

void epg_host_services_stop(const epg_host_services_t *services);

#endif
