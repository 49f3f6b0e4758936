/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Body of main() of a host executable.
 */
#include "epg/host.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "options.h"
#include "report.h"
#include "run.h"
#include "serial.h"
#include "setpoints.h"
#include "store.h"

enum { DONE = 0, FAILED = 1, WRONG_INPUT = 2, INTERRUPTED = 130 };

/** The files that a run writes.  NULL if a file is not wanted. */
typedef struct outputs {
    FILE *topics;
    FILE *trace;
    FILE *statistics;
} outputs_t;

static void on_interrupt(int number)
{
    (void)number;
    epg_host_interrupted = 1;
}

/** Opens `path` for writing.  Returns true and does nothing if `path` is NULL. */
static bool open_output(const char *path, FILE **file)
{
    if (path == NULL) {
        return true;
    }
    *file = fopen(path, "wb"); /* binary: the same bytes on each system */
    if (*file == NULL) {
        fprintf(stderr, "%s: error: cannot write this file: %s\n", path, strerror(errno));
    }
    return *file != NULL;
}

static bool close_output(const char *path, FILE *file)
{
    if (file == NULL) {
        return true;
    }
    const bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed) {
        fprintf(stderr, "%s: error: cannot write this file: %s\n", path, errno != 0 ? strerror(errno) : "failed");
        return false;
    }
    return true;
}

/** Runs the target and writes the files.  They are open, and the events are read. */
static int run_target(const epg_host_target_t *host, const epg_host_options_t *options, const epg_host_events_t *events,
                      const outputs_t *outputs, const epg_host_services_t *services)
{
    static epg_host_run_t run; /* too large for a small stack */
    const epg_target_t *target = host->target;
    const uint64_t cycles = (options->duration_ns - 1) / target->application->period_ns + 1;
    run = (epg_host_run_t){.host = host,
                           .end_ns = options->duration_ns,
                           .services = *services,
                           .ends_with_input = services->terminal != NULL && options->duration_ns == UINT64_MAX};
    if (!epg_host_communication_start(&run.communication, target, events, run.end_ns, outputs->topics)) {
        return FAILED;
    }
    if (!epg_host_trace_start(&run.trace, host, outputs->trace, options->realtime, cycles)) {
        epg_host_communication_end(&run.communication);
        return FAILED;
    }
    epg_host_run_start(&run, options->realtime ? target->application : epg_host_prepare_simulated(&run));
    int status = DONE;
    if (options->realtime) {
        status = epg_host_run_realtime(&run) ? DONE : FAILED;
    } else {
        epg_host_run_simulated(&run);
    }
    epg_host_trace_end(&run.trace);
    epg_host_communication_end(&run.communication);
    if (status == DONE && outputs->statistics != NULL) {
        epg_host_write_statistics(outputs->statistics, &run);
    }
    if (run.diverged != NULL) {
        status = FAILED;
    }
    if (status == DONE && !options->quiet && !options->console) {
        epg_host_print_summary(&run);
    }
    return status == DONE && epg_host_interrupted ? INTERRUPTED : status;
}

/** Opens the terminal of the console, if the options request one, and runs the target. */
static int run_with_terminal(const epg_host_target_t *host, const epg_host_options_t *options,
                             const epg_host_events_t *events, const outputs_t *outputs, epg_host_link_t *link,
                             const char *agent)
{
    epg_host_terminal_t terminal;
    epg_host_services_t services = {.target = host->target, .link = link, .agent = options->quiet ? NULL : agent};
    if (!options->console && options->console_pty == NULL) {
        return run_target(host, options, events, outputs, &services);
    }
    if (epg_host_console(host) == NULL) {
        fprintf(stderr, "error: this target has no console\nhint: 'communication: {%s}' in its .tcf gives it one\n",
                epg_host_is_connected(host) ? "console: true" : "middleware: console");
        return WRONG_INPUT;
    }
    if (options->console) {
        epg_host_terminal_standard(&terminal);
    } else if (!epg_host_terminal_open(&terminal, options->console_pty)) {
        return FAILED;
    }
    services.terminal = &terminal;
    const int status = run_target(host, options, events, outputs, &services);
    epg_host_terminal_close(&terminal);
    return status;
}

/** Opens the link to the agent, if the target has one and the run is in real time, and runs the target. */
static int run_with_link(const epg_host_target_t *host, const epg_host_options_t *options,
                         const epg_host_events_t *events, const outputs_t *outputs)
{
    static epg_host_link_t link;
    const char *agent = options->agent != NULL ? options->agent : options->device;
    if (agent != NULL && host->agent == NULL) {
        fputs("error: this target has no agent\nhint: 'communication: {middleware: xrce}' in its .tcf makes it talk to "
              "one\n",
              stderr);
        return WRONG_INPUT;
    }
    if (host->agent == NULL || !options->realtime) {
        return run_with_terminal(host, options, events, outputs, NULL, NULL);
    }
    agent = agent != NULL ? agent : host->agent;
    if (agent[0] == '\0') {
        fputs("error: nobody says which terminal the agent is on\n"
              "hint: --serial-device PATH, or 'communication: {transport: serial, device: PATH}' in the .tcf\n",
              stderr);
        return WRONG_INPUT;
    }
    if (options->device != NULL) {
        epg_host_link_serial(&link, agent, host->baud_rate);
    } else if (!epg_host_link_open(&link, agent, host->baud_rate)) {
        return FAILED;
    }
    const int status = run_with_terminal(host, options, events, outputs, &link, agent);
    epg_host_link_close(&link);
    return status;
}

static int run_with_files(const epg_host_target_t *host, const epg_host_options_t *options,
                          const epg_host_events_t *events)
{
    outputs_t outputs = {NULL, NULL, NULL};
    int status = FAILED;
    if (open_output(options->topics, &outputs.topics) && open_output(options->trace, &outputs.trace) &&
        open_output(options->statistics, &outputs.statistics)) {
        status = run_with_link(host, options, events, &outputs);
    }
    errno = 0;
    const bool topics = close_output(options->topics, outputs.topics);
    const bool trace = close_output(options->trace, outputs.trace);
    const bool statistics = close_output(options->statistics, outputs.statistics);
    return topics && trace && statistics ? status : FAILED;
}

int epg_host_main(const epg_host_target_t *host, int argc, char **argv)
{
    epg_host_options_t options;
    if (!epg_host_read_options(argc, argv, epg_host_is_connected(host), &options)) {
        return WRONG_INPUT;
    }
    if (options.help) {
        epg_host_print_help(host->target->application->name);
        return DONE;
    }
    if (options.interface) {
        epg_host_print_interface(host);
        return DONE;
    }
    epg_host_events_t events = {NULL, 0};
    if (options.setpoints != NULL && !epg_host_read_setpoints(options.setpoints, host, options.realtime, &events)) {
        return WRONG_INPUT;
    }
    epg_host_store_open(options.store);
    if (options.serial != NULL) {
        epg_host_serial_set(options.serial);
    }
    epg_host_interrupted = 0;
    signal(SIGINT, on_interrupt);
    signal(SIGTERM, on_interrupt);
    const int status = run_with_files(host, &options, &events);
    epg_host_free_setpoints(&events);
    return status;
}
