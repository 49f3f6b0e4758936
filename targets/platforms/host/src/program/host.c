/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Body of main() of a host executable.
 */
#include "epg/host.h"

#include <fenv.h>

#include "epg/host_log.h"
#include "files/files.h"
#include "files/replay.h"
#include "files/setpoints.h"
#include "interface.h"
#include "loop/run.h"
#include "options.h"
#include "port/serial.h"
#include "port/signals.h"
#include "port/store.h"
#include "report.h"
#include "ros/ros.h"
#include "ros/ros_parameters.h"

static void on_interrupt(int number)
{
    (void)number;
    epg_host_interrupted = 1;
}

/** Lets the run end regularly at Ctrl-C, SIGTERM, and when its terminal closes. */
static void catch_interrupts(void)
{
    epg_host_interrupted = 0;
    epg_host_signals_catch(on_interrupt);
}

/** True if the run ends like that of any ROS 2 node: Ctrl-C is its regular end, which a launch file must not report. */
static bool is_ros_node(const epg_host_options_t *options)
{
    return options->ros.given && options->duration_ns == UINT64_MAX;
}

/** Reports a run that has come to its end: its statistics and its summary.  Returns the exit status of the program. */
static int report(const epg_host_run_t *run, const epg_host_options_t *options, const epg_host_files_t *files)
{
    if (files->statistics != NULL) {
        epg_host_write_statistics(files->statistics, run);
    }
    if (run->diverged != NULL) {
        return FAILED;
    }
    if (!options->quiet && !options->console) {
        epg_host_print_summary(run);
    }
    return epg_host_interrupted && !is_ros_node(options) ? INTERRUPTED : DONE;
}

/** Runs the target and writes the files.  They are open, and the events are read. */
static int run_target(const epg_host_target_t *host, const epg_host_options_t *options, const epg_host_events_t *events,
                      const epg_host_files_t *files, const epg_host_services_t *services)
{
    static epg_host_run_t run; /* too large for a small stack */
    const epg_target_t *target = host->target;
    const uint64_t cycles = (options->duration_ns - 1) / target->application->period_ns + 1;
    run = (epg_host_run_t){.host = host,
                           .end_ns = options->duration_ns,
                           .pace = options->pace,
                           .services = *services,
                           .ends_with_input = services->terminal != NULL && options->duration_ns == UINT64_MAX};
    if (!epg_host_communication_start(&run.communication, target, events, run.end_ns, files->topics)) {
        return FAILED;
    }
    if (!epg_host_trace_start(&run.trace, host, files->trace, options->realtime, cycles)) {
        epg_host_communication_end(&run.communication);
        return FAILED;
    }
    epg_host_run_start(&run, options->realtime ? target->application : epg_host_prepare_simulated(&run));
    if (epg_host_logs(EPG_HOST_LOG_WARN)) {
        epg_host_store_tell(target->store);
    }
    if (options->ros.given) {
        epg_host_ros_set_parameters(target);
    }
    bool done = true;
    if (options->realtime) {
        done = epg_host_run_realtime(&run);
    } else {
        epg_host_run_simulated(&run);
    }
    epg_host_trace_end(&run.trace);
    epg_host_communication_end(&run.communication);
    return done ? report(&run, options, files) : FAILED;
}

/** Opens the connections of the middlewares, and runs the target. */
static int run_with_services(const epg_host_target_t *host, const epg_host_options_t *options,
                             const epg_host_events_t *events, const epg_host_files_t *files)
{
    epg_host_services_t services;
    int status = epg_host_services_open(&services, host, options);
    if (status != DONE) {
        return status;
    }
    status = epg_host_services_identify(&services);
    if (status == DONE) {
        status = run_target(host, options, events, files, &services);
    }
    epg_host_services_close(&services);
    return status;
}

static int run_with_files(const epg_host_target_t *host, const epg_host_options_t *options,
                          const epg_host_events_t *events)
{
    epg_host_files_t files;
    const bool opened = epg_host_files_open(&files, options);
    const int status = opened ? run_with_services(host, options, events, &files) : FAILED;
    return epg_host_files_close(&files, options) ? status : FAILED;
}

/** Opens the store, and applies the arguments after --ros-args to `target`.  Returns false after a message. */
static bool prepare_target(epg_target_t *target, const epg_host_options_t *options)
{
    epg_host_store_open(options->store);
    if (options->serial != NULL) {
        epg_host_serial_set(options->serial);
    }
    return !options->ros.given || epg_host_ros_prepare(&options->ros, target);
}

/** Replays a recording, and writes the trace. */
static int replay(const epg_host_target_t *host, const epg_host_options_t *options)
{
    epg_host_files_t files;
    const bool opened = epg_host_files_open(&files, options);
    const int status = opened ? epg_host_replay(host, options->replay, files.trace, options->quiet) : FAILED;
    return epg_host_files_close(&files, options) ? status : FAILED;
}

int epg_host_main(const epg_host_target_t *generated, int argc, char **argv)
{
    /* A program that was linked with -ffast-math starts in a mode in which the processor replaces tiny numbers by zero. */
    (void)fesetenv(FE_DFL_ENV);
    epg_host_options_t options;
    if (!epg_host_read_options(argc, argv, epg_host_is_connected(generated), &options)) {
        return WRONG_INPUT;
    }
    if (options.help) {
        epg_host_print_help(generated->target->application->name);
        return DONE;
    }
    if (options.interface) {
        epg_host_print_interface(generated);
        return DONE;
    }
    if (options.replay != NULL) {
        return replay(generated, &options);
    }
    static epg_target_t target; /* a copy of the generated constant, which can have other names */
    target = *generated->target;
    epg_host_target_t changed = *generated;
    changed.target = &target;
    const epg_host_target_t *host = &changed;
    epg_host_events_t events = {NULL, 0};
    if (options.setpoints != NULL && !epg_host_read_setpoints(options.setpoints, host, options.realtime, &events)) {
        return WRONG_INPUT;
    }
    if (!prepare_target(&target, &options)) {
        epg_host_free_setpoints(&events);
        return WRONG_INPUT;
    }
    if (options.pace > 0.0 && !epg_host_pace_prepare(&target)) {
        epg_host_free_setpoints(&events);
        return FAILED;
    }
    catch_interrupts();
    const int status = run_with_files(host, &options, &events);
    epg_host_free_setpoints(&events);
    return status;
}
