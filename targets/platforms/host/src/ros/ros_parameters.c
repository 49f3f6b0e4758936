/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Parameters of the model that a command line or a file sets.
 *
 * Only parameters of the model can be set, so no value can enable a target.
 */
#include "ros_parameters.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/finite.h"
#include "epg/host_log.h"
#include "files/number.h"
#include "ros_names.h"

enum { NAMES_SHOWN = 10, NAME_SIZE = 256 };

/** Parameters that every node of ROS 2 has; launch files set them for all nodes. */
static const char *const of_every_node[] = {"use_sim_time", "start_type_description_service"};

static struct {
    epg_parameters_t *parameters; /* NULL: the target has none */
    double *values;               /* one for each parameter; on the heap, like `given`, until the program ends */
    bool *given;
} read;

/** True if `ros` is the name in ROS of the model's parameter `name`: "Pan.PID.kp" of "Pan\PID\kp". */
static bool is_name(const char *name, const char *ros)
{
    size_t i = 0;
    while (name[i] != '\0' && ros[i] == (name[i] == '\\' ? '.' : name[i])) {
        i++;
    }
    return name[i] == '\0' && ros[i] == '\0';
}

/** Index of the parameter with this name in ROS; SIZE_MAX if there is none. */
static size_t find(const char *ros)
{
    for (size_t i = 0; read.parameters != NULL && i < read.parameters->count; i++) {
        if (is_name(read.parameters->table[i].name, ros)) {
            return i;
        }
    }
    return SIZE_MAX;
}

/** Begins a message about `value`.  A message about a file has the form of a compiler's. */
static void begin(const epg_host_ros_value_t *value, const char *severity)
{
    if (value->place != NULL) {
        fprintf(stderr, "%s: %s: ", value->place, severity);
    } else {
        fprintf(stderr, "%s: -p: ", severity);
    }
}

static void print_name(const char *name)
{
    for (; *name != '\0'; name++) {
        fputc(*name == '\\' ? '.' : *name, stderr);
    }
}

static void list_names(void)
{
    const size_t count = read.parameters != NULL ? read.parameters->count : 0;
    fputs(count == 0 ? "hint: this target has no parameters that can be set" : "hint: the parameters of this target:",
          stderr);
    for (size_t i = 0; i < count && i < NAMES_SHOWN; i++) {
        fputs(i == 0 ? " " : ", ", stderr);
        print_name(read.parameters->table[i].name);
    }
    if (count > NAMES_SHOWN) {
        fprintf(stderr, " and %zu more", count - NAMES_SHOWN);
    }
    fputc('\n', stderr);
}

/** Handles a parameter that every node has.  Returns false if it is not one. */
static bool is_of_every_node(const epg_host_ros_value_t *value)
{
    for (size_t i = 0; i < sizeof of_every_node / sizeof of_every_node[0]; i++) {
        if (strcmp(value->name, of_every_node[i]) == 0) {
            if (i == 0 && strcmp(value->text, "true") == 0 && epg_host_logs(EPG_HOST_LOG_WARN)) {
                begin(value, "warning");
                fputs("use_sim_time has no effect: this program does not read /clock\n", stderr);
            }
            return true;
        }
    }
    return strncmp(value->name, "qos_overrides.", strlen("qos_overrides.")) == 0;
}

static bool refuse_unknown(const epg_host_ros_value_t *value)
{
    if (value->for_all) {
        if (epg_host_logs(EPG_HOST_LOG_WARN)) {
            begin(value, "warning");
            fprintf(stderr, "this target has no parameter '%s'\n", value->name);
        }
        return true;
    }
    begin(value, "error");
    fprintf(stderr, "there is no parameter '%s'\n", value->name);
    list_names();
    return false;
}

/** Reads a number as YAML writes it, such as 2.5, 1e-3 or .inf. */
static bool parse_number(const char *text, double *number)
{
    const char *digits = text[0] == '+' || text[0] == '-' ? text + 1 : text;
    if (digits[0] == '.' && (digits[1] < '0' || digits[1] > '9')) {
        *number = strtod(digits + 1, NULL); /* .inf, .nan: not finite; the sign does not matter */
        return strcmp(digits, ".inf") == 0 || strcmp(digits, ".nan") == 0;
    }
    return epg_host_parse_number(text, number);
}

bool epg_host_ros_take_value(const epg_host_ros_value_t *value)
{
    double number = 0.0;
    const size_t index = find(value->name);
    if (index == SIZE_MAX) {
        return is_of_every_node(value) || refuse_unknown(value);
    }
    if (value->quoted || !parse_number(value->text, &number)) {
        begin(value, "error");
        fprintf(stderr, "parameter '%s' must be a number: '%s' is not one\n", value->name, value->text);
        return false;
    }
    if (!epg_is_finite(number)) {
        begin(value, "error");
        fprintf(stderr, "parameter '%s' must be finite, not %s\n", value->name, value->text);
        return false;
    }
    if (!epg_parameters_can_be(read.parameters, index, number)) {
        begin(value, "error");
        fprintf(stderr, "parameter '%s' must be from %g to %g, not %s\n", value->name,
                read.parameters->limits[index].minimum, read.parameters->limits[index].maximum, value->text);
        return false;
    }
    read.values[index] = number;
    read.given[index] = true;
    return true;
}

/** Reads `text`: [NODE:]NAME:=VALUE. */
static bool read_argument(const char *text, const char *node)
{
    char name[NAME_SIZE] = "";
    char pattern[NAME_SIZE] = "/";
    size_t prefix;
    const char *start = epg_host_ros_after_prefix(text, &prefix);
    const char *assignment = strstr(text, ":=");
    const size_t length = assignment != NULL ? (size_t)(assignment - start) : 0;
    if (length == 0 || length >= sizeof name || prefix >= sizeof pattern - 1 || assignment[2] == '\0') {
        fprintf(stderr,
                "error: -p '%s' does not set a parameter\nhint: write NAME:=VALUE, for example Pan.PID.kp:=2.5\n",
                text);
        return false;
    }
    memcpy(name, start, length);
    memcpy(text[0] == '/' ? pattern : pattern + 1, text, prefix);
    return (prefix > 0 && !epg_host_ros_is_node(pattern, node)) ||
           epg_host_ros_take_value(&(epg_host_ros_value_t){.name = name, .text = assignment + 2});
}

bool epg_host_ros_read_parameters(const epg_host_ros_t *ros, const epg_target_t *target)
{
    read.parameters = target->application->parameters;
    const size_t count = read.parameters != NULL ? read.parameters->count : 0;
    free(read.values);
    free(read.given);
    read.values = calloc(count + 1, sizeof *read.values);
    read.given = calloc(count + 1, sizeof *read.given);
    if (read.values == NULL || read.given == NULL) {
        fputs("error: not enough memory for the parameters\n", stderr);
        return false;
    }
    char node[EPG_HOST_ROS_NODE_SIZE];
    snprintf(node, sizeof node, "%s", epg_host_ros_node(target));
    bool good = true;
    for (size_t i = 0; i < ros->count; i++) {
        if (ros->rules[i].kind == EPG_HOST_ROS_PARAMETER) {
            good = read_argument(ros->rules[i].text, node) && good;
        } else if (ros->rules[i].kind == EPG_HOST_ROS_PARAMETER_FILE) {
            good = epg_host_ros_read_file(ros->rules[i].text, node) && good;
        }
    }
    return good;
}

/* Passes the changes to the control side, which has not begun its cycles: this thread takes its part, too. */
void epg_host_ros_set_parameters(const epg_target_t *target)
{
    if (read.parameters == NULL || !epg_parameters_idle(read.parameters)) {
        return;
    }
    for (size_t i = 0; i < read.parameters->count; i++) {
        if (read.given[i]) {
            epg_parameters_prepare(read.parameters, i, read.values[i]);
        }
    }
    epg_parameters_request(read.parameters);
    epg_parameters_apply(read.parameters, target->control->model_valid);
}
