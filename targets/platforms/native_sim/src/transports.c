/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams from the simulation to the computer: to the agent, and to the user.
 *
 * Their functions are those of the platform `host`, in the native simulator around the image.  None of them waits.
 */
#include <zephyr/kernel.h>

#include "links/services.h"
#include "parts.h"
#include "port/clock.h"

static epg_host_services_t services;

static bool start(void *context, const char *title)
{
    ARG_UNUSED(context);
    ARG_UNUSED(title);
    return true; /* the streams were opened before Zephyr was booted */
}

epg_transport_t epg_native_sim_agent = {.start = start};
epg_transport_t epg_native_sim_terminal = {.start = start};

/* This platform has no option for a console by UDP. */

epg_host_udp_console_t *epg_host_udp_console_open(const epg_host_options_t *options, const epg_target_t *target)
{
    ARG_UNUSED(options);
    ARG_UNUSED(target);
    return NULL;
}

void epg_host_udp_console_close(epg_host_udp_console_t *console)
{
    ARG_UNUSED(console);
}

/* Start and end -------------------------------------------------------------------------------------------------- */

int epg_native_sim_open_transports(void)
{
    static epg_host_link_t nobody; /* a terminal that is never opened */
    const int status = epg_host_services_open(&services, epg_native_sim_target, &epg_native_sim_options);
    epg_host_link_serial(&nobody, NULL, 0);
    nobody.retry_ns = UINT64_MAX;
    epg_native_sim_agent.stream = services.link != NULL ? services.link->stream : nobody.stream;
    epg_native_sim_terminal.stream = services.terminal != NULL ? services.terminal->stream : nobody.stream;
    return status;
}

void epg_native_sim_close_transports(void)
{
    epg_host_services_close(&services);
}

void epg_native_sim_tell_connection(void)
{
    epg_host_services_tell(&services);
}

bool epg_native_sim_input_ended(void)
{
    return services.terminal != NULL && epg_native_sim_options.duration_ns == UINT64_MAX &&
           epg_host_terminal_ended(services.terminal, epg_host_monotonic_ns());
}
