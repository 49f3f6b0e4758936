/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Real time on systems other than Linux: all functions fail with a message.
 */
#include <stdio.h>

#include "epg/host.h"
#include "loop/run.h"

static bool unavailable(void)
{
    fputs("error: real time on the host needs Linux\nhint: remove --realtime to run in simulated time\n", stderr);
    return false;
}

bool epg_host_is_connected(const epg_host_target_t *host)
{
    (void)host;
    return false;
}

bool epg_host_link_is_address(const char *text)
{
    (void)text;
    return true;
}

int epg_host_services_open(epg_host_services_t *services, const epg_host_target_t *host,
                           const epg_host_options_t *options)
{
    *services = (epg_host_services_t){.target = host->target};
    return options->realtime && !unavailable() ? FAILED : DONE;
}

int epg_host_services_identify(const epg_host_services_t *services)
{
    (void)services;
    return DONE;
}

void epg_host_services_close(epg_host_services_t *services)
{
    (void)services;
}

bool epg_host_run_realtime(epg_host_run_t *run)
{
    (void)run;
    return unavailable();
}

bool epg_host_pace_prepare(epg_target_t *target)
{
    (void)target;
    return unavailable();
}

void epg_host_pace_start(epg_host_run_t *run)
{
    (void)run;
}

void epg_host_pace_wait(epg_host_run_t *run, uint64_t tick_ns)
{
    (void)run;
    (void)tick_ns;
}

void epg_host_pace_end(epg_host_run_t *run)
{
    (void)run;
}

bool epg_host_start(const epg_host_target_t *host)
{
    (void)host;
    return unavailable();
}

bool epg_host_stop(void)
{
    return true;
}
