/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The arguments after `--ros-args`, applied to a target.
 */
#include "ros.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "epg/host_log.h"
#include "epg/store.h"
#include "ros_names.h"
#include "ros_parameters.h"

static bool equal_ignoring_case(const char *a, const char *b)
{
    while (*a != '\0' && tolower((unsigned char)*a) == tolower((unsigned char)*b)) {
        a++;
        b++;
    }
    return *a == *b;
}

/** True if the first `length` characters of `logger` name the logger of the node: "robot_1.JIWY_node". */
static bool is_logger(const char *logger, size_t length, const epg_target_t *target)
{
    const char *node = epg_host_ros_node(target) + 1;
    bool equal = strlen(node) == length;
    for (size_t i = 0; i < length && equal; i++) {
        equal = logger[i] == (node[i] == '/' ? '.' : node[i]);
    }
    return equal;
}

/** Sets the level of `text`, which is LEVEL or LOGGER:=LEVEL.  The level of another logger has no effect. */
static bool set_log_level(const char *text, const epg_target_t *target)
{
    static const char *const levels[] = {"debug", "info", "warn", "error", "fatal"};
    const char *assignment = strstr(text, ":=");
    const char *level = assignment != NULL ? assignment + 2 : text;
    for (size_t i = 0; i < sizeof levels / sizeof levels[0]; i++) {
        if (equal_ignoring_case(level, levels[i])) {
            if (assignment == NULL || is_logger(text, (size_t)(assignment - text), target)) {
                epg_host_log_set((epg_host_log_t)i);
            }
            return true;
        }
    }
    fprintf(stderr, "error: --log-level '%s' is not a level\nhint: the levels are debug, info, warn, error, fatal\n",
            level);
    return false;
}

static bool accept_enclave(const char *path)
{
    if (strcmp(path, "/") == 0) {
        return true;
    }
    fprintf(stderr,
            "error: --enclave '%s': this program does not support the security of ROS 2 (SROS 2)\n"
            "hint: remove --enclave\n",
            path);
    return false;
}

bool epg_host_ros_prepare(const epg_host_ros_t *ros, epg_target_t *target)
{
    if (target->store != NULL) {
        epg_store_load(target->store); /* the stored names, by which rules and parameters select the node */
    }
    bool good = epg_host_ros_rename(ros, target);
    for (size_t i = 0; i < ros->count; i++) {
        const epg_host_ros_rule_t *rule = &ros->rules[i];
        if (rule->kind == EPG_HOST_ROS_LOG_LEVEL) {
            good = set_log_level(rule->text, target) && good;
        } else if (rule->kind == EPG_HOST_ROS_NO_LOG) {
            epg_host_log_set(EPG_HOST_LOG_NONE);
        } else if (rule->kind == EPG_HOST_ROS_ENCLAVE) {
            good = accept_enclave(rule->text) && good;
        }
    }
    return good && epg_host_ros_read_parameters(ros, target);
}
