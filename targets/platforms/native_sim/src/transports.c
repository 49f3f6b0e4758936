/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams from the simulation to the computer: to the agent, and to the user.
 *
 * Their functions are those of the platform `host`, in the native simulator around the image.  None of them waits.
 */
#include <zephyr/kernel.h>

#include "clock.h"
#include "parts.h"
#include "services.h"

static epg_host_services_t services;

/* A stream without connection -------------------------------------------------------------------------------------- */

static bool never_connected(void *context)
{
    ARG_UNUSED(context);
    return false;
}

static size_t read_nothing(void *context, void *data, size_t size)
{
    ARG_UNUSED(context);
    ARG_UNUSED(data);
    ARG_UNUSED(size);
    return 0;
}

static size_t write_nothing(void *context, const void *data, size_t size)
{
    ARG_UNUSED(context);
    ARG_UNUSED(data);
    ARG_UNUSED(size);
    return 0;
}

static size_t no_room(void *context)
{
    ARG_UNUSED(context);
    return 0;
}

static bool start(void *context, const char *title)
{
    ARG_UNUSED(context);
    ARG_UNUSED(title);
    return true; /* the streams were opened before Zephyr was booted */
}

#define NOBODY                                                                                                         \
    {                                                                                                                  \
        .connected = never_connected, .read = read_nothing, .write = write_nothing, .writable = no_room                \
    }

epg_transport_t epg_native_sim_agent = {.start = start, .stream = NOBODY};
epg_transport_t epg_native_sim_terminal = {.start = start, .stream = NOBODY};

/* Start and end -------------------------------------------------------------------------------------------------- */

int epg_native_sim_open_transports(void)
{
    const int status = epg_host_services_open(&services, epg_native_sim_target, &epg_native_sim_options);
    if (services.link != NULL) {
        epg_native_sim_agent.stream = services.link->stream;
    }
    if (services.terminal != NULL) {
        epg_native_sim_terminal.stream = services.terminal->stream;
    }
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
