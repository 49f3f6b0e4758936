/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Streams from the simulation to the computer: to the agent, and to the user.
 *
 * Their functions are those of the platform `host`, in the native simulator around the image.  None of them waits.
 */
#include <stdio.h>
#include <string.h>

#include <zephyr/kernel.h>

#include "epg/middleware.h"
#include "link.h"
#include "parts.h"
#include "services.h"
#include "terminal.h"

#include "clock.h"

static epg_host_link_t agent;
static epg_host_terminal_t terminal;
static bool has_agent;
static bool has_terminal;

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

/*
 * The agent ---------------------------------------------------------------------------------------------------------
 */

static const char *agent_name(void)
{
    const epg_host_options_t *options = &epg_native_sim_options;
    const char *given = options->agent != NULL ? options->agent : options->device;
    return given != NULL ? given : epg_native_sim_target->agent;
}

static int open_agent(void)
{
    const epg_host_options_t *options = &epg_native_sim_options;
    const epg_host_target_t *target = epg_native_sim_target;
    if (target->agent == NULL && (options->agent != NULL || options->device != NULL)) {
        fputs("error: this target has no agent\nhint: 'communication: {middleware: xrce}' in its .tcf makes it talk to "
              "one\n",
              stderr);
        return WRONG_INPUT;
    }
    if (target->agent == NULL || !options->realtime) {
        return DONE;
    }
    if (agent_name()[0] == '\0') {
        fputs("error: nobody says which terminal the agent is on\n"
              "hint: --serial-device=PATH, or 'communication: {transport: serial, device: PATH}' in the .tcf\n",
              stderr);
        return WRONG_INPUT;
    }
    if (options->device != NULL) {
        epg_host_link_serial(&agent, options->device, target->baud_rate);
    } else if (!epg_host_link_open(&agent, agent_name(), target->baud_rate)) {
        return FAILED;
    }
    epg_native_sim_agent.stream = agent.stream;
    has_agent = true;
    return DONE;
}

void epg_native_sim_tell_connection(void)
{
    static const char *told;
    static bool running;
    const epg_target_t *target = epg_native_sim_target->target;
    if (!has_agent || target->middleware == NULL || target->middleware->state == NULL) {
        return;
    }
    const char *state = target->middleware->state();
    if (state == told) {
        return;
    }
    told = state;
    if (running != (strcmp(state, "running") == 0)) {
        running = !running;
        if (!epg_native_sim_options.quiet) {
            fprintf(stderr, running ? "%s: connected to the agent at %s\n" : "%s: lost the agent at %s\n",
                    target->application->name, agent_name());
        }
    }
}

/*
 * The terminal ------------------------------------------------------------------------------------------------------
 */

static int open_terminal(void)
{
    const epg_host_options_t *options = &epg_native_sim_options;
    if (!options->console && options->console_pty == NULL) {
        return DONE;
    }
    if (epg_host_console(epg_native_sim_target) == NULL) {
        fprintf(stderr, "error: this target has no console\nhint: 'communication: {%s}' in its .tcf gives it one\n",
                epg_host_is_connected(epg_native_sim_target) ? "console: true" : "middleware: console");
        return WRONG_INPUT;
    }
    if (options->console) {
        epg_host_terminal_standard(&terminal);
    } else if (!epg_host_terminal_open(&terminal, options->console_pty)) {
        return FAILED;
    }
    epg_native_sim_terminal.stream = terminal.stream;
    has_terminal = true;
    return DONE;
}

bool epg_native_sim_input_ended(void)
{
    return has_terminal && epg_native_sim_options.duration_ns == UINT64_MAX && terminal.end_ns != 0 &&
           epg_host_terminal_ended(&terminal, epg_host_monotonic_ns());
}

/*
 * Both ---------------------------------------------------------------------------------------------------------------
 */

int epg_native_sim_open_transports(void)
{
    const int status = open_agent();
    return status == DONE ? open_terminal() : status;
}

void epg_native_sim_close_transports(void)
{
    if (has_terminal) {
        epg_host_terminal_close(&terminal);
        has_terminal = false;
    }
    if (has_agent) {
        epg_host_link_close(&agent);
        has_agent = false;
    }
}
