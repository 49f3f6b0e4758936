/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Where a target's middlewares are connected.
 */
#include <stddef.h>

#include "services.h"

/* One that needs no stream can wait for its own connection. */
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
