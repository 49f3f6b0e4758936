/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The command line of a host executable.
 */
#include "options.h"

#include <stdio.h>
#include <string.h>

#include "files/number.h"
#include "links/link.h"
#include "links/udp_address.h"

/** The range of --pace.  The time-outs of a connection follow simulated time. */
#define PACE_MIN 0.01
#define PACE_MAX 100.0

void epg_host_print_help(const char *name)
{
    printf("usage: %s [options] --duration SECONDS\n"
           "       %s [options] --realtime [--console]\n"
           "       %s [options] --pace FACTOR\n"
           "\n"
           "Runs the target '%s' against its simulated plant.\n"
           "\n"
           "  --duration SECONDS   duration of the run; in real time, a console or ROS 2 node needs none\n"
           "  --realtime           runs in real time (default: simulated time)\n"
           "  --pace FACTOR        simulated time at FACTOR times real time, as a ROS 2 node with /clock\n"
           "  --console            reads commands from standard input, answers on standard output (real time)\n"
           "  --console-pty PATH   the same on a terminal with this name, like the serial port of a board\n"
           "  --console-udp [ADDRESS:]PORT\n"
           "                       the same by UDP, for 'epg live udp:HOST:PORT'; default address: 127.0.0.1.\n"
           "                       On an address of the network, users need a key, which the program prints\n"
           "  --console-key FILE   the key, 32 hexadecimal digits, which nobody else may be able to read\n"
           "  --console-open       no key: anyone who can send datagrams to the address can move the robot\n"
           "  --agent HOST:PORT    address of the ROS 2 agent (real time; default: as in the .tcf)\n"
           "  --serial-device PATH serial device of the ROS 2 agent, such as /dev/ttyUSB0\n"
           "  --store FILE         file in which the console and ROS 2 store parameters\n"
           "  --serial WORD        replaces '$serial' in the names of node and namespace; default: host\n"
           "  --setpoints FILE     reads setpoints from a CSV file with rows time,topic,value\n"
           "  --topics FILE        writes all published values in the same form\n"
           "  --trace FILE         writes all signals, one row per control cycle\n"
           "  --statistics FILE    writes the run's statistics as JSON\n"
           "  --replay FILE        replays a recording of 'epg live --record': the model alone, no plant\n"
           "  --quiet              prints no summary\n"
           "  --interface          prints the names of topics, digital inputs and signals, for programs\n"
           "  --help               prints this text\n"
           "  --ros-args ...       arguments of ROS 2 (-r, -p, --params-file, --log-level), up to --\n"
           "\n"
           "Exit status: 0 done; 1 the run or the writing of a file failed, or the plant diverged;\n"
           "2 wrong options or setpoint file; 130 interrupted (all files are complete up to this moment).\n",
           name, name, name, name);
}

/** An option of the command line: a flag, or a text value.  One of the two pointers is NULL. */
typedef struct option {
    const char *name;
    bool *flag;
    const char **value;
    bool replays; /**< it can be combined with --replay */
} option_t;

/** Length of the option's name in `argument`: up to "=", or up to the end. */
static size_t name_length(const char *argument)
{
    return strcspn(argument, "=");
}

static const option_t *find(const option_t *options, size_t count, const char *argument)
{
    const size_t length = name_length(argument);
    for (size_t i = 0; i < count; i++) {
        if (strlen(options[i].name) == length && strncmp(options[i].name, argument, length) == 0) {
            return &options[i];
        }
    }
    return NULL;
}

/** Takes the option at argv[*i].  Increments *i if the option's value is the next argument.  False after a message. */
static bool take(const option_t *option, int argc, char **argv, int *i)
{
    const char *given = strchr(argv[*i], '=');
    if (option->flag != NULL) {
        *option->flag = true;
        if (given != NULL) {
            fprintf(stderr, "error: option %s must not have a value\n", option->name);
        }
        return given == NULL;
    }
    if (given == NULL && *i + 1 < argc) {
        *i += 1;
        *option->value = argv[*i];
    } else {
        *option->value = given == NULL ? "" : given + 1;
    }
    if ((*option->value)[0] == '\0') {
        fprintf(stderr, "error: option %s needs a value\n", option->name);
    }
    return (*option->value)[0] != '\0';
}

static void refuse_unknown(const char *argument)
{
    fprintf(stderr, "error: unknown option '%s'\n", argument);
    if (strstr(argument, ":=") != NULL) {
        fprintf(stderr, "hint: write --ros-args -r %s\n", argument);
    } else {
        fputs("hint: --help lists the options\n", stderr);
    }
}

/** Takes all arguments.  Returns false after a message. */
static bool take_all(const option_t *known, size_t count, int argc, char **argv, epg_host_ros_t *ros)
{
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--ros-args") == 0) {
            if (!epg_host_ros_take(ros, argc, argv, &i)) {
                return false;
            }
            continue;
        }
        const option_t *option = find(known, count, argv[i]);
        if (option == NULL) {
            refuse_unknown(argv[i]);
            return false;
        }
        if (!take(option, argc, argv, &i)) {
            return false;
        }
    }
    return true;
}

/** True if a console by UDP has an address, and one kind of access; false after a message. */
static bool udp_console_fits(const epg_host_options_t *options)
{
    if ((options->console_key != NULL || options->console_open) && options->console_udp == NULL) {
        fprintf(stderr, "error: %s without --console-udp\nhint: only a console by UDP has a key\n",
                options->console_open ? "--console-open" : "--console-key");
        return false;
    }
    if (options->console_key != NULL && options->console_open) {
        fputs("error: --console-key and --console-open\nhint: an open console has no key: remove one of the options\n",
              stderr);
        return false;
    }
    epg_host_udp_address_t address;
    if (options->console_udp != NULL && (!epg_host_udp_address_split(options->console_udp, &address) ||
                                         (strchr(address.host, ':') != NULL && options->console_udp[0] != '['))) {
        fprintf(stderr,
                "error: --console-udp '%s' is not [ADDRESS:]PORT\n"
                "hint: for example --console-udp 7000, or 192.168.1.10:7000, or [::1]:7000\n",
                options->console_udp);
        return false;
    }
    return true;
}

/** True if there is at most one console, in real time; false after a message. */
static bool consoles_fit(const epg_host_options_t *options)
{
    const char *given[3];
    size_t count = 0;
    if (options->console) {
        given[count++] = "--console";
    }
    if (options->console_pty != NULL) {
        given[count++] = "--console-pty";
    }
    if (options->console_udp != NULL) {
        given[count++] = "--console-udp";
    }
    if (count > 1) {
        fprintf(stderr, "error: %s and %s\nhint: a target has one console: remove one of the options\n", given[0],
                given[1]);
        return false;
    }
    if (count > 0 && !options->realtime) {
        fprintf(stderr, "error: %s without --realtime\nhint: a console needs real time: add --realtime\n", given[0]);
        return false;
    }
    return udp_console_fits(options);
}

/** True if the options can be combined; false after a message. */
static bool fit_together(const epg_host_options_t *options)
{
    if (!consoles_fit(options)) {
        return false;
    }
    if (options->agent != NULL && options->device != NULL) {
        fputs("error: --agent and --serial-device\nhint: a target has one agent: remove one of the options\n", stderr);
        return false;
    }
    if (options->pace > 0.0 && options->realtime) {
        fputs("error: --pace and --realtime\nhint: --pace is for simulated time: remove one of the options\n", stderr);
        return false;
    }
    if ((options->agent != NULL || options->device != NULL) && !epg_host_connects(options)) {
        fprintf(stderr, "error: %s without --realtime\nhint: an agent needs real time: add --realtime, or --pace\n",
                options->agent != NULL ? "--agent" : "--serial-device");
        return false;
    }
    if (options->agent != NULL && !epg_host_link_is_address(options->agent)) {
        fprintf(stderr, "error: --agent '%s' is not HOST:PORT\nhint: for example --agent 192.168.1.10:8888\n",
                options->agent);
        return false;
    }
    return true;
}

/** Takes the value of --pace; NULL: not given. */
static bool take_pace(const char *text, bool connected, epg_host_options_t *options)
{
    if (text == NULL) {
        return true;
    }
    if (!epg_host_parse_number(text, &options->pace) || !(options->pace >= PACE_MIN && options->pace <= PACE_MAX)) {
        fprintf(stderr, "error: --pace '%s' is not a factor from 0.01 to 100\nhint: --pace 1 is as fast as real time\n",
                text);
        return false;
    }
    if (!connected) {
        fputs("error: --pace: this target is not a ROS 2 node\nhint: 'communication: {middleware: dds}' in the .tcf "
              "makes it one; without --pace, simulated time does not wait\n",
              stderr);
        return false;
    }
    return true;
}

/** True if the options can be combined with --replay; false after a message. */
static bool is_replay_alone(const option_t *known, size_t count, const epg_host_ros_t *ros)
{
    bool alone = !ros->given;
    for (size_t i = 0; i < count; i++) {
        const bool given = known[i].flag != NULL ? *known[i].flag : *known[i].value != NULL;
        alone = alone && (known[i].replays || !given);
    }
    if (!alone) {
        fputs("error: --replay with another option than --trace and --quiet\n"
              "hint: the recording has the inputs, the parameters and the duration of the run\n",
              stderr);
    }
    return alone;
}

/** True if the run reads or writes files, which are those of a simulation unless --realtime is given. */
static bool has_files(const epg_host_options_t *options)
{
    return options->setpoints != NULL || options->topics != NULL || options->trace != NULL ||
           options->statistics != NULL;
}

bool epg_host_read_options(int argc, char **argv, bool connected, epg_host_options_t *options)
{
    *options = (epg_host_options_t){0};
    const char *duration = NULL;
    const char *pace = NULL;
    const option_t known[] = {
        {"--help", &options->help, NULL, true},
        {"--quiet", &options->quiet, NULL, true},
        {"--realtime", &options->realtime, NULL, false},
        {"--duration", NULL, &duration, false},
        {"--pace", NULL, &pace, false},
        {"--setpoints", NULL, &options->setpoints, false},
        {"--topics", NULL, &options->topics, false},
        {"--trace", NULL, &options->trace, true},
        {"--statistics", NULL, &options->statistics, false},
        {"--replay", NULL, &options->replay, true},
        {"--console", &options->console, NULL, false},
        {"--console-pty", NULL, &options->console_pty, false},
        {"--console-udp", NULL, &options->console_udp, false},
        {"--console-key", NULL, &options->console_key, false},
        {"--console-open", &options->console_open, NULL, false},
        {"--store", NULL, &options->store, false},
        {"--serial", NULL, &options->serial, true},
        {"--interface", &options->interface, NULL, true},
        {"--agent", NULL, &options->agent, false},
        {"--serial-device", NULL, &options->device, false},
    };
    const size_t count = sizeof known / sizeof known[0];
    if (!take_all(known, count, argc, argv, &options->ros)) {
        return false;
    }
    if (options->replay != NULL && !options->help && !options->interface) {
        return is_replay_alone(known, count, &options->ros);
    }
    /* `ros2 run` and launch files start a node without options of this program. */
    options->realtime = options->realtime ||
                        (connected && duration == NULL && pace == NULL && (options->ros.given || !has_files(options)));
    return options->help || options->interface ||
           (take_pace(pace, connected, options) && epg_host_complete_options(duration, connected, options));
}

bool epg_host_complete_options(const char *duration, bool connected, epg_host_options_t *options)
{
    if (!fit_together(options)) {
        return false;
    }
    const bool served = epg_host_has_console(options) || (epg_host_connects(options) && connected);
    if (duration == NULL && served && options->trace == NULL) {
        options->duration_ns = UINT64_MAX;
        return true;
    }
    if (duration == NULL) {
        fputs("error: --duration is missing\nhint: give the number of seconds, for example --duration 10\n", stderr);
        return false;
    }
    if (!epg_host_parse_time(duration, &options->duration_ns) || options->duration_ns == 0) {
        fprintf(stderr, "error: --duration '%s' is not a time in seconds above 0\n", duration);
        return false;
    }
    return true;
}
