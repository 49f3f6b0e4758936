/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Remapping rules.
 *
 * The order is that of rcl: first the name of the node, then its namespace, then topics.  Both sides of a topic's rule
 * are expanded with the new names of the node, and the rule is for the topic with exactly this full name.
 */
#include "ros_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/names.h"
#include "epg/node.h"
#include "epg/store.h"

static const char topic_scheme[] = "rostopic://";
static const char service_scheme[] = "rosservice://";

typedef enum subject { NODE, NAME_SPACE, TOPIC, SERVICE, ANY } subject_t;

typedef struct rule {
    subject_t subject;              /* ANY: a topic or a service */
    char node[EPG_STORE_NAME_SIZE]; /* the rule is for this node only; "": for every node */
    char from[EPG_NODE_TOPIC_SIZE]; /* as it was given, later the full name */
    char to[EPG_NODE_TOPIC_SIZE];   /* the same */
} rule_t;

static struct {
    char node[EPG_STORE_NAME_SIZE];
    char name_space[EPG_STORE_NAME_SIZE];
    size_t count;
    rule_t *rules; /* on the heap until the program ends */
} names;

/* Parsing ------------------------------------------------------------------------------------------------------ */

const char *epg_host_ros_after_prefix(const char *text, size_t *length)
{
    const size_t found = strcspn(text, ":");
    const bool prefix = text[found] == ':' && text[found + 1] != '=' && strncmp(text + found, "://", 3) != 0;
    *length = prefix ? found : 0;
    return prefix ? text + found + 1 : text;
}

static bool is_word(char c, bool first)
{
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || (!first && c >= '0' && c <= '9');
}

/** True if `name` is the name of a topic or service: absolute, relative, or private with a leading "~/". */
static bool is_topic(const char *name)
{
    const char *rest = name[0] == '~' && name[1] == '/' ? name + 2 : name[0] == '/' ? name + 1 : name;
    do {
        const char *start = rest;
        while (is_word(*rest, rest == start)) {
            rest++;
        }
        if (rest == start || (*rest != '/' && *rest != '\0')) {
            return false;
        }
    } while (*rest++ == '/');
    return true;
}

/** Copies `length` characters.  Returns false if they do not fit. */
static bool copy(char *to, size_t size, const char *from, size_t length)
{
    if (length >= size) {
        return false;
    }
    memcpy(to, from, length);
    to[length] = '\0';
    return true;
}

static bool refuse(const char *text, const char *problem, const char *hint)
{
    fprintf(stderr, "error: -r '%s': %s\nhint: %s\n", text, problem, hint);
    return false;
}

/** Checks the new name of `rule`, which was made of `text`. */
static bool check(const rule_t *rule, const char *text)
{
    if (rule->subject == NODE && !epg_names_is_node(rule->to)) {
        return refuse(text, "this is not the name of a node",
                      "a name has letters, digits and '_', and does not begin with a digit: __node:=jiwy_1");
    }
    if (rule->subject == NAME_SPACE && !epg_names_is_space(rule->to)) {
        return refuse(text, "this is not a namespace",
                      "a namespace begins with '/', and each of its parts is a name: __ns:=/robot_1");
    }
    if (rule->subject >= TOPIC && (!is_topic(rule->from) || !is_topic(rule->to))) {
        return refuse(text, "a name of a topic has letters, digits, '_' and '/'; wildcards are not supported",
                      "write for example pan_subscriber:=/joystick/pan, or __node:=NAME, __ns:=/NAMESPACE");
    }
    return true;
}

/** Reads `text`: [NODE:][rostopic://|rosservice://]FROM:=TO.  Returns false after a message. */
static bool parse(rule_t *rule, const char *text)
{
    size_t prefix;
    const char *assignment = strstr(text, ":=");
    const char *from = epg_host_ros_after_prefix(text, &prefix);
    if (assignment == NULL) {
        return refuse(text, "this is not a rule", "write FROM:=TO, for example pan_subscriber:=/joystick/pan");
    }
    rule->subject = ANY;
    if (strncmp(from, topic_scheme, sizeof topic_scheme - 1) == 0) {
        rule->subject = TOPIC;
        from += sizeof topic_scheme - 1;
    } else if (strncmp(from, service_scheme, sizeof service_scheme - 1) == 0) {
        rule->subject = SERVICE;
        from += sizeof service_scheme - 1;
    }
    const char *to = assignment + 2;
    if (!copy(rule->node, sizeof rule->node, text, prefix) ||
        !copy(rule->from, sizeof rule->from, from, (size_t)(assignment - from)) ||
        !copy(rule->to, sizeof rule->to, to, strlen(to))) {
        return refuse(text, "a name is too long", "shorten the names");
    }
    if (strcmp(rule->from, "__node") == 0 || strcmp(rule->from, "__name") == 0) {
        rule->subject = NODE;
    } else if (strcmp(rule->from, "__ns") == 0) {
        rule->subject = NAME_SPACE;
    }
    return check(rule, text);
}

/* Names -------------------------------------------------------------------------------------------------------- */

/** Replaces `name` by the full name.  Returns false if it does not fit. */
static bool expand(char name[EPG_NODE_TOPIC_SIZE])
{
    char full[2 * EPG_NODE_TOPIC_SIZE];
    const char *space = names.name_space;
    if (name[0] == '~') {
        snprintf(full, sizeof full, "%s/%s%s", space, names.node, name + 1);
    } else {
        snprintf(full, sizeof full, "%s%s%s", name[0] == '/' ? "" : space, name[0] == '/' ? "" : "/", name);
    }
    return copy(name, EPG_NODE_TOPIC_SIZE, full, strlen(full));
}

/** The function `rename` of a target: the first rule for this name. */
static const char *rename_topic(const char *name, bool service)
{
    for (size_t i = 0; i < names.count; i++) {
        const rule_t *rule = &names.rules[i];
        const bool fits = rule->subject == ANY || rule->subject == (service ? SERVICE : TOPIC);
        if (fits && strcmp(rule->from, name) == 0) {
            return rule->to;
        }
    }
    return name;
}

static bool is_for_node(const rule_t *rule)
{
    return rule->node[0] == '\0' || strcmp(rule->node, names.node) == 0;
}

static const char *first(subject_t subject)
{
    for (size_t i = 0; i < names.count; i++) {
        if (names.rules[i].subject == subject && is_for_node(&names.rules[i])) {
            return names.rules[i].to;
        }
    }
    return NULL;
}

/** Takes the names of the target, with its serial number. */
static void take_names(const epg_target_t *target)
{
    (void)epg_names_expand(epg_names_node(target), names.node, sizeof names.node);
    (void)epg_names_expand(epg_names_space(target), names.name_space, sizeof names.name_space);
}

const char *epg_host_ros_node(const epg_target_t *target)
{
    static char full[EPG_HOST_ROS_NODE_SIZE];
    take_names(target);
    snprintf(full, sizeof full, "%s/%s", names.name_space, names.node);
    return full;
}

static void rename_node(epg_target_t *target)
{
    take_names(target);
    target->given_node = first(NODE);
    take_names(target);
    const char *space = first(NAME_SPACE);
    target->given_space = space != NULL && strcmp(space, "/") == 0 ? "" : space;
    take_names(target);
}

/** Expands the rules of topics, and leaves out those of other nodes. */
static bool expand_rules(void)
{
    for (size_t i = 0; i < names.count; i++) {
        rule_t *rule = &names.rules[i];
        if (rule->subject < TOPIC || !is_for_node(rule)) {
            rule->from[0] = '\0'; /* the full name of a topic is never empty */
        } else if (!expand(rule->from) || !expand(rule->to)) {
            return refuse(rule->to, "the full name is too long", "shorten the names");
        }
    }
    return true;
}

bool epg_host_ros_rename(const epg_host_ros_t *ros, epg_target_t *target)
{
    bool good = true;
    free(names.rules);
    names.count = 0;
    names.rules = calloc(ros->count + 1, sizeof *names.rules);
    if (names.rules == NULL) {
        fputs("error: not enough memory for the remapping rules\n", stderr);
        return false;
    }
    for (size_t i = 0; i < ros->count; i++) {
        if (ros->rules[i].kind == EPG_HOST_ROS_REMAP) {
            good = parse(&names.rules[names.count++], ros->rules[i].text) && good;
        }
    }
    if (!good) {
        return false;
    }
    rename_node(target);
    target->rename = rename_topic;
    return expand_rules();
}
