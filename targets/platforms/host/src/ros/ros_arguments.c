/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The arguments after `--ros-args`: the table of them.
 */
#include "ros_arguments.h"

#include <stdio.h>
#include <string.h>

typedef struct flag {
    const char *name;
    const char *short_name; /* NULL: none */
    epg_host_ros_kind_t kind;
    const char *value; /* the form of the next argument, which is the value; NULL: the flag has no value */
} flag_t;

static const flag_t flags[] = {
    {"--remap", "-r", EPG_HOST_ROS_REMAP, "FROM:=TO"},
    {"--param", "-p", EPG_HOST_ROS_PARAMETER, "NAME:=VALUE"},
    {"--params-file", NULL, EPG_HOST_ROS_PARAMETER_FILE, "FILE"},
    {"--log-level", NULL, EPG_HOST_ROS_LOG_LEVEL, "LEVEL"},
    {"--enclave", "-e", EPG_HOST_ROS_ENCLAVE, "PATH"},
    {"--disable-stdout-logs", NULL, EPG_HOST_ROS_NO_LOG, NULL},
    {"--enable-stdout-logs", NULL, EPG_HOST_ROS_IGNORED, NULL},
    /* The program has no topic /rosout, no library for logging and no log file. */
    {"--disable-rosout-logs", NULL, EPG_HOST_ROS_IGNORED, NULL},
    {"--enable-rosout-logs", NULL, EPG_HOST_ROS_IGNORED, NULL},
    {"--disable-external-lib-logs", NULL, EPG_HOST_ROS_IGNORED, NULL},
    {"--enable-external-lib-logs", NULL, EPG_HOST_ROS_IGNORED, NULL},
    {"--log-config-file", NULL, EPG_HOST_ROS_IGNORED, "FILE"},
    {"--log-file-name", NULL, EPG_HOST_ROS_IGNORED, "NAME"},
};

static const flag_t *find(const char *argument)
{
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        if (strcmp(argument, flags[i].name) == 0 ||
            (flags[i].short_name != NULL && strcmp(argument, flags[i].short_name) == 0)) {
            return &flags[i];
        }
    }
    return NULL;
}

static void refuse_unknown(const char *argument)
{
    fprintf(stderr, "error: unknown argument '%s' after --ros-args\n", argument);
    if (strstr(argument, ":=") != NULL) {
        fprintf(stderr, "hint: write -r %s to change a name, -p %s to set a parameter\n", argument, argument);
    } else {
        fputs("hint: -- ends the arguments of ROS 2; the options of this program are before --ros-args or after --\n",
              stderr);
    }
}

bool epg_host_ros_take(epg_host_ros_t *ros, int argc, char **argv, int *i)
{
    ros->given = true;
    while (*i + 1 < argc) {
        const char *argument = argv[++*i];
        if (strcmp(argument, "--") == 0) {
            return true;
        }
        if (strcmp(argument, "--ros-args") == 0) {
            continue; /* launch_ros writes it twice if a launch file has ROS arguments of its own */
        }
        const flag_t *flag = find(argument);
        if (flag == NULL) {
            refuse_unknown(argument);
            return false;
        }
        if (flag->value != NULL && *i + 1 >= argc) {
            fprintf(stderr, "error: argument %s needs a value\nhint: write %s %s\n", argument, argument, flag->value);
            return false;
        }
        if (ros->count == EPG_HOST_ROS_RULES) {
            fprintf(stderr,
                    "error: more than %d arguments after --ros-args\nhint: write parameters into a file, and "
                    "name it by --params-file\n",
                    EPG_HOST_ROS_RULES);
            return false;
        }
        ros->rules[ros->count++] =
            (epg_host_ros_rule_t){.kind = flag->kind, .text = flag->value != NULL ? argv[++*i] : ""};
    }
    return true;
}
