/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The file of failures.
 */
#include "failures.h"

#include <stdlib.h>
#include <string.h>

#include "files/number.h"

enum { LONGEST_LINE = 256 };

static const char *const names[] = {
    [FAILURE_DIE] = "die",     [FAILURE_HANG] = "hang",       [FAILURE_RESTART] = "restart",
    [FAILURE_STALL] = "stall", [FAILURE_OFFLINE] = "offline", [FAILURE_ONLINE] = "online",
};

/** Reads one line.  Returns NULL, or what is wrong. */
static const char *read_line(const epg_system_t *system, char *line, failure_t *failure)
{
    char *const target = strchr(line, ',');
    char *const event = target == NULL ? NULL : strchr(target + 1, ',');
    if (event == NULL) {
        return "a line must have a time, a target and an event";
    }
    *target = '\0';
    *event = '\0';
    if (!epg_host_parse_time(line, &failure->time_ns)) {
        return "the time must be a number of seconds";
    }
    failure->target = simulation_target(system, target + 1, strlen(target + 1));
    if (failure->target == system->target_count) {
        return "the system has no target of this name";
    }
    char *const blank = strchr(event + 1, ' ');
    if (blank != NULL) {
        *blank = '\0';
    }
    const size_t count = sizeof names / sizeof names[0];
    size_t kind = 0;
    while (kind < count && strcmp(names[kind], event + 1) != 0) {
        kind++;
    }
    failure->kind = (failure_kind_t)kind;
    failure->duration_ns = 0;
    if (kind == count || (kind != FAILURE_STALL && blank != NULL)) {
        return "an event is die, hang, restart, stall SECONDS, offline or online";
    }
    const bool is_stall = kind == FAILURE_STALL;
    const bool has_time = blank != NULL && epg_host_parse_time(blank + 1, &failure->duration_ns);
    return is_stall && (!has_time || failure->duration_ns == 0) ? "a stall needs its seconds: 'stall 0.02'" : NULL;
}

static bool keep(simulation_t *simulation, const failure_t *failure)
{
    const size_t size = (simulation->failure_count + 1U) * sizeof *failure;
    failure_t *failures = realloc(simulation->failures, size);
    if (failures == NULL) {
        return false;
    }
    simulation->failures = failures;
    simulation->failures[simulation->failure_count++] = *failure;
    return true;
}

bool failures_read(simulation_t *simulation, const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        fprintf(stderr, "%s: error: cannot read this file\n", path);
        return false;
    }
    char line[LONGEST_LINE];
    const char *problem = NULL;
    unsigned int number = 0;
    while (problem == NULL && fgets(line, sizeof line, file) != NULL) {
        number++;
        const bool whole = strchr(line, '\n') != NULL || feof(file) != 0;
        line[strcspn(line, "\r\n")] = '\0';
        failure_t failure;
        if (!whole) {
            problem = "this line is too long";
        } else if (number == 1) {
            problem = strcmp(line, "time,target,event") == 0 ? NULL : "the first line must be 'time,target,event'";
        } else if (line[0] != '\0') {
            problem = read_line(simulation->system, line, &failure);
            problem = problem != NULL || keep(simulation, &failure) ? problem : "not enough memory";
        }
    }
    fclose(file);
    if (problem != NULL) {
        fprintf(stderr, "%s:%u: error: %s\n", path, number, problem);
    }
    return problem == NULL;
}
