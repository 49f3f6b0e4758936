/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The command line of an image.  EPG's options are added to those of native_sim, and have its form: -option=value.
 */
#include <stdio.h>

#include <cmdline.h>
#include <nsi_timer_model.h>
#include <posix_board_if.h>
#include <posix_native_task.h>
#include <zephyr/kernel.h>

#include "files/setpoints.h"
#include "parts.h"
#include "port/serial.h"
#include "port/store.h"
#include "program/interface.h"

BUILD_ASSERT(IS_ENABLED(CONFIG_EXTERNAL_LIBC),
             "EPG's native_sim reads and writes files of this computer: CONFIG_EXTERNAL_LIBC must be set");

epg_host_options_t epg_native_sim_options;
epg_host_events_t epg_native_sim_events;

static char *duration;

#define FLAG(member, text)                                                                                             \
    {                                                                                                                  \
        .option = #member, .is_switch = true, .type = 'b', .dest = &epg_native_sim_options.member, .descript = (text)  \
    }
#define VALUE(text_option, text_value, member, text)                                                                   \
    {                                                                                                                  \
        .option = (text_option), .name = (text_value), .type = 's', .dest = &epg_native_sim_options.member,            \
        .descript = (text)                                                                                             \
    }

static void add_options(void)
{
    static struct args_struct_t options[] = {
        {.option = "duration",
         .name = "SECONDS",
         .type = 's',
         .dest = &duration,
         .descript = "EPG: duration of the run, in simulated time without -realtime"},
        FLAG(realtime, "EPG: runs in real time"),
        FLAG(console, "EPG: reads commands from standard input, answers on standard output"),
        VALUE("console-pty", "PATH", console_pty, "EPG: the same on a terminal with this name"),
        VALUE("agent", "HOST:PORT", agent, "EPG: address of the ROS 2 agent; default: as in the .tcf"),
        VALUE("serial-device", "PATH", device, "EPG: serial device of the ROS 2 agent"),
#ifndef CONFIG_EPG_STORE
        VALUE("store", "FILE", store, "EPG: file in which the console's 'save' stores parameters"),
#endif
        VALUE("serial", "WORD", serial, "EPG: replaces '$serial' in the names of node and namespace; default: host"),
        VALUE("setpoints", "FILE", setpoints, "EPG: reads setpoints from a CSV file with rows time,topic,value"),
        VALUE("topics", "FILE", topics, "EPG: writes all published values in the same form"),
        VALUE("trace", "FILE", trace, "EPG: writes all signals, one row per control cycle"),
        VALUE("statistics", "FILE", statistics, "EPG: writes the run's statistics as JSON"),
        FLAG(interface, "EPG: prints the names of topics, digital inputs and signals, for programs"),
        FLAG(quiet, "EPG: prints no summary"),
        ARG_TABLE_ENDMARKER,
    };
    native_add_command_line_opts(options);
}

NATIVE_TASK(add_options, PRE_BOOT_1, 10);

/**
 * Completes and checks the options.  Without a duration the run counts as real time: the target then has its
 * connections.  False after a message.
 */
static bool complete(void)
{
    epg_host_options_t *options = &epg_native_sim_options;
    const bool realtime = options->realtime;
    options->realtime = realtime || duration == NULL;
    if (!epg_host_complete_options(duration, true, options)) {
        return false;
    }
    if (realtime || duration != NULL) {
        hwtimer_set_real_time_mode(realtime);
    }
    return true;
}

static void read_options(void)
{
    const epg_host_options_t *options = &epg_native_sim_options;
    if (options->interface) {
        epg_host_print_interface(epg_native_sim_target);
        posix_exit(DONE);
    }
    if (!complete()) {
        posix_exit(WRONG_INPUT);
    }
    if (options->setpoints != NULL &&
        !epg_host_read_setpoints(options->setpoints, epg_native_sim_target, false, &epg_native_sim_events)) {
        posix_exit(WRONG_INPUT);
    }
#ifndef CONFIG_EPG_STORE
    epg_host_store_open(options->store);
#endif
    if (options->serial != NULL) {
        epg_host_serial_set(options->serial);
    }
    const int status = epg_native_sim_open_transports();
    if (status != DONE) {
        posix_exit(status);
    }
}

NATIVE_TASK(read_options, PRE_BOOT_2, 10);
