/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middlewares that run beside the control loop in real time: the target's own, and its console.
 *
 * The target's middleware connects by itself, or it has a link to an agent; else it is what sits on the terminal.  A
 * console beside a middleware that is connected sits on the terminal in its place.
 */
#ifndef EPG_HOST_SERVICES_H
#define EPG_HOST_SERVICES_H

#include <stdbool.h>
#include <stdint.h>

#include "link.h"
#include "terminal.h"

#include "epg/host.h"
#include "epg/middleware.h"

typedef struct epg_host_services {
    const epg_target_t *target;
    epg_host_link_t *link;         /**< to the agent of the target's middleware; NULL: there is none */
    const char *agent;             /**< where it is, for people; NULL: nothing is said of the connection */
    const char *state;             /**< of the connection, as said last; NULL: it is not running */
    epg_host_terminal_t *terminal; /**< NULL: there is none */
} epg_host_services_t;

/** Whether the target's middleware makes its connection itself. */
bool epg_host_connects_itself(const epg_target_t *target);

/** Whether the target's middleware has a connection, and needs no terminal. */
bool epg_host_is_connected(const epg_host_target_t *host);

/** What sits on a terminal if there is one; NULL: nothing does. */
const epg_middleware_t *epg_host_console(const epg_host_target_t *host);

/** Whether anything runs. */
bool epg_host_services_run(const epg_host_services_t *services);

void epg_host_services_start(const epg_host_services_t *services);

/**
 * Sleeps until monotonic time `time_ns` or until something arrives, a millisecond at most; then serves all.  What
 * becomes of the connection to an agent is said on stderr.
 */
void epg_host_services_serve(epg_host_services_t *services, uint64_t time_ns);

void epg_host_services_stop(const epg_host_services_t *services);

#endif
