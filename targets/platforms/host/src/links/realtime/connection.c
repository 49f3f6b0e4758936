/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The connections of a target's middlewares: by themselves, to an agent, or to the user of a console.
 */
#include "links/services.h"

#include <stdio.h>
#include <string.h>

#include "epg/host_log.h"

static epg_host_link_t link_to_agent;
static epg_host_terminal_t terminal;

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

static int open_link(epg_host_services_t *services, const epg_host_target_t *host, const epg_host_options_t *options)
{
    const char *agent = options->agent != NULL ? options->agent : options->device;
    if (agent != NULL && host->agent == NULL) {
        fputs("error: this target has no agent\nhint: 'communication: {middleware: xrce}' in the .tcf connects it to "
              "one\n",
              stderr);
        return WRONG_INPUT;
    }
    if (host->agent == NULL || !epg_host_connects(options)) {
        return DONE;
    }
    agent = agent != NULL ? agent : host->agent;
    if (agent[0] == '\0') {
        fputs("error: the serial device of the agent is not given\n"
              "hint: add --serial-device=PATH, or 'communication: {transport: serial, device: PATH}' in the .tcf\n",
              stderr);
        return WRONG_INPUT;
    }
    const bool opened = options->device != NULL ? epg_host_link_serial(&link_to_agent, agent, host->baud_rate)
                                                : epg_host_link_open(&link_to_agent, agent, host->baud_rate);
    if (!opened) {
        return FAILED;
    }
    services->link = &link_to_agent;
    services->agent = agent;
    services->quiet = options->quiet;
    return DONE;
}

static int open_console(epg_host_services_t *services, const epg_host_target_t *host, const epg_host_options_t *options)
{
    if (!epg_host_has_console(options)) {
        return DONE;
    }
    if (epg_host_console(host) == NULL) {
        fprintf(stderr, "error: this target has no console\nhint: 'communication: {%s}' in the .tcf adds one\n",
                epg_host_is_connected(host) ? "console: true" : "middleware: console");
        return WRONG_INPUT;
    }
    if (options->console_udp != NULL) {
        services->udp = epg_host_udp_console_open(options, host->target);
        return services->udp != NULL ? DONE : FAILED;
    }
    if (options->console) {
        epg_host_terminal_standard(&terminal);
    } else if (!epg_host_terminal_open(&terminal, options->console_pty)) {
        return FAILED;
    }
    services->terminal = &terminal;
    return DONE;
}

int epg_host_services_open(epg_host_services_t *services, const epg_host_target_t *host,
                           const epg_host_options_t *options)
{
    *services = (epg_host_services_t){.target = host->target};
    int status = open_link(services, host, options);
    if (status == DONE) {
        status = open_console(services, host, options);
    }
    if (status != DONE) {
        epg_host_services_close(services);
    }
    return status;
}

void epg_host_services_close(epg_host_services_t *services)
{
    if (services->terminal != NULL) {
        epg_host_terminal_close(services->terminal);
    }
    if (services->udp != NULL) {
        epg_host_udp_console_close(services->udp);
    }
    if (services->link != NULL) {
        epg_host_link_close(services->link);
    }
    services->terminal = NULL;
    services->udp = NULL;
    services->link = NULL;
}

void epg_host_services_tell(epg_host_services_t *services)
{
    const epg_middleware_t *middleware = services->target->middleware;
    if (services->agent == NULL || middleware == NULL || middleware->state == NULL) {
        return;
    }
    const char *state = middleware->state();
    const bool running = strcmp(state, "running") == 0;
    if (running != (services->state != NULL)) {
        services->quiet = services->quiet && running; /* a loss is always told, and what comes after it */
        if (!services->quiet && epg_host_logs(EPG_HOST_LOG_INFO)) {
            fprintf(stderr, running ? "%s: connected to the agent at %s\n" : "%s: lost the agent at %s\n",
                    services->target->application->name, services->agent);
        }
        services->state = running ? state : NULL;
    }
}
