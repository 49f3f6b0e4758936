/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The connections of a target's middlewares: by themselves, to an agent, or to a terminal.
 */
#include <stddef.h>

#include "services.h"

/* A middleware that makes its own connection has a function to wait for it. */
bool epg_host_connects_itself(const epg_target_t *target)
{
    return target->middleware != NULL && target->middleware->wait != NULL;
}

bool epg_host_is_connected(const epg_host_target_t *host)
{
    return host->agent != NULL || epg_host_connects_itself(host->target);
}

const epg_middleware_t *epg_host_console(const epg_host_target_t *host)
{
    if (host->target->console != NULL || epg_host_is_connected(host)) {
        return host->target->console;
    }
    return host->target->middleware;
}
