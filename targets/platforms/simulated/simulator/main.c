/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The program that simulates a system: its options and files.
 */
#include <fenv.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "failures.h"
#include "files/number.h"
#include "report.h"
#include "simulate.h"

enum { DONE = 0, FAILED = 1, WRONG_OPTIONS = 2 };

typedef struct options {
    uint64_t duration_ns;
    uint64_t seed;
    const char *trace;      /* folder */
    const char *topics;     /* file */
    const char *statistics; /* file */
    char folder[4096];      /* of the program */
} options_t;

static void help(const epg_system_t *system, FILE *file)
{
    fprintf(file,
            "usage: %s --duration SECONDS [options]\n"
            "\n"
            "Simulates all targets of the system, their messages and plants.\n"
            "\n"
            "  --duration SECONDS          duration of the run\n"
            "  --seed NUMBER               seed of the random numbers (default: 0)\n"
            "  --setpoints TARGET=FILE     reads setpoints of a target from a CSV file with rows time,topic,value\n"
            "  --events FILE               reads failures of targets from a CSV file with rows time,target,event\n"
            "  --trace FOLDER              writes all signals into FOLDER/TARGET.csv, one row per control cycle, and\n"
            "                              those of the system's plant into FOLDER/plant.csv, one row per step\n"
            "  --topics FILE               writes all published values\n"
            "  --statistics FILE           writes the states of the targets at the end, as JSON\n"
            "  --interface                 prints the names of targets, topics and signals, for programs\n"
            "  --help                      prints this text\n",
            system->name);
}

static int usage(const epg_system_t *system, const char *problem, const char *word)
{
    fprintf(stderr, "%s: error: %s%s\n", system->name, problem, word);
    help(system, stderr);
    return WRONG_OPTIONS;
}

/** Reads the setpoints of `value`, TARGET=FILE.  Returns DONE, or another exit status after a message. */
static int read_setpoints(simulation_t *simulation, const char *value)
{
    const char *equals = strchr(value, '=');
    const size_t length = equals == NULL ? 0 : (size_t)(equals - value);
    const size_t target = simulation_target(simulation->system, value, length);
    if (target == simulation->system->target_count) {
        return usage(simulation->system, "this does not name a target: ", value);
    }
    member_t *member = &simulation->members[target];
    epg_host_free_setpoints(&member->events);
    return epg_host_read_setpoints(equals + 1, member->unit->host, false, &member->events) ? DONE : WRONG_OPTIONS;
}

/** Reads one option with its value.  Returns DONE, or another exit status after a message. */
static int take(simulation_t *simulation, options_t *options, const char *option, const char *value)
{
    if (strcmp(option, "--duration") == 0) {
        return epg_host_parse_time(value, &options->duration_ns) && options->duration_ns > 0
                   ? DONE
                   : usage(simulation->system, "this is not a duration in seconds: ", value);
    }
    if (strcmp(option, "--seed") == 0) {
        char *end = NULL;
        options->seed = strtoull(value, &end, 10);
        return *value != '\0' && *end == '\0' ? DONE : usage(simulation->system, "this is not a number: ", value);
    }
    if (strcmp(option, "--trace") == 0) {
        options->trace = value;
        return DONE;
    }
    if (strcmp(option, "--topics") == 0) {
        options->topics = value;
        return DONE;
    }
    if (strcmp(option, "--statistics") == 0) {
        options->statistics = value;
        return DONE;
    }
    if (strcmp(option, "--setpoints") == 0) {
        return read_setpoints(simulation, value);
    }
    if (strcmp(option, "--events") == 0) {
        return failures_read(simulation, value) ? DONE : WRONG_OPTIONS;
    }
    return usage(simulation->system, "there is no option ", option);
}

static bool open_plant(simulation_t *simulation, const char *folder)
{
    const epg_system_plant_t *facts = simulation->system->plant;
    simulation->plant.facts = facts;
    return plant_open(&simulation->plant, folder, facts->file, facts->step_ns, facts->divisor, facts->starts_by_step);
}

/** Loads the system's plant, and its targets.  Returns false after a message. */
static bool open_targets(simulation_t *simulation, const char *folder)
{
    const epg_system_t *system = simulation->system;
    if (system->plant != NULL && !open_plant(simulation, folder)) {
        return false;
    }
    for (size_t i = 0; i < system->target_count; i++) {
        if (!member_open(&simulation->members[i], &system->targets[i], folder, &simulation->plant)) {
            return false;
        }
    }
    return true;
}

/** Reads all options.  Returns DONE, or another exit status after a message. */
static int read_options(simulation_t *simulation, options_t *options, int argc, char **argv)
{
    for (int i = 1; i < argc; i += 2) {
        const int status = i + 1 < argc ? take(simulation, options, argv[i], argv[i + 1])
                                        : usage(simulation->system, "this option needs a value: ", argv[i]);
        if (status != DONE) {
            return status;
        }
    }
    return options->duration_ns > 0 ? DONE : usage(simulation->system, "--duration is missing", "");
}

/** Opens FOLDER/`name`.csv.  Returns NULL after a message. */
static FILE *open_csv(const options_t *options, const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.csv", options->trace, name);
    FILE *file = fopen(path, "wb");
    if (file == NULL) {
        fprintf(stderr, "%s: error: cannot write this file\n", path);
    }
    return file;
}

static bool open_trace(member_t *member, const options_t *options)
{
    member->file = open_csv(options, member->facts->name);
    if (member->file == NULL) {
        return false;
    }
    const uint64_t cycles = options->duration_ns / member->unit->host->target->application->period_ns + 1U;
    return epg_host_trace_start(&member->trace, member->unit->host, member->file, false, cycles);
}

/** Opens the traces of the targets, and that of the system's plant.  Returns false after a message. */
static bool open_traces(simulation_t *simulation, const options_t *options)
{
    for (size_t i = 0; i < simulation->system->target_count; i++) {
        if (!open_trace(&simulation->members[i], options)) {
            return false;
        }
    }
    if (simulation->system->plant != NULL) {
        FILE *file = open_csv(options, "plant");
        if (file == NULL) {
            return false;
        }
        plant_record(&simulation->plant, file);
    }
    return true;
}

/** Opens the file of all published values.  Returns false after a message. */
static bool open_topics(simulation_t *simulation, const char *path)
{
    simulation->topics = fopen(path, "wb");
    if (simulation->topics == NULL) {
        fprintf(stderr, "%s: error: cannot write this file\n", path);
        return false;
    }
    fputs("time,topic,value\n", simulation->topics);
    return true;
}

static void print_state(const member_t *member)
{
    const epg_target_t *target = member->unit->host->target;
    const epg_control_t *control = target->control;
    const char *component = epg_target_component(target, control->fault_component);
    const bool of_component = control->fault != EPG_FAULT_NONE && component[0] != '\0';
    printf("%s: %" PRIu32 " cycles, %s, fault: %s%s%s%s\n", member->facts->name, control->statistics.cycles,
           control->enabled ? "enabled" : "disabled", epg_target_fault(target, control->fault),
           of_component ? " (" : "", of_component ? component : "", of_component ? ")" : "");
}

static bool write_statistics(const simulation_t *simulation, const char *path)
{
    FILE *file = fopen(path, "wb");
    if (file != NULL) {
        report_statistics(simulation, file);
    }
    if (file == NULL || fclose(file) != 0) {
        fprintf(stderr, "%s: error: cannot write this file\n", path);
        return false;
    }
    return true;
}

static int run(simulation_t *simulation, options_t *options, int argc, char **argv)
{
    const epg_system_t *system = simulation->system;
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        help(system, stdout);
        return DONE;
    }
    if (!open_targets(simulation, options->folder)) {
        return FAILED;
    }
    if (argc == 2 && strcmp(argv[1], "--interface") == 0) {
        report_interface(simulation);
        return DONE;
    }
    const int status = read_options(simulation, options, argc, argv);
    if (status != DONE) {
        return status;
    }
    if (options->trace != NULL && !open_traces(simulation, options)) {
        return FAILED;
    }
    if (options->topics != NULL && !open_topics(simulation, options->topics)) {
        return FAILED;
    }
    simulation->end_ns = options->duration_ns;
    simulation->seed = options->seed;
    if (!simulate(simulation)) {
        return FAILED;
    }
    for (size_t i = 0; i < system->target_count; i++) {
        print_state(&simulation->members[i]);
    }
    return options->statistics == NULL || write_statistics(simulation, options->statistics) ? DONE : FAILED;
}

int epg_system_main(const epg_system_t *system, int argc, char **argv)
{
    /* A program that was linked with -ffast-math starts in a mode in which the processor replaces tiny numbers by zero. */
    (void)fesetenv(FE_DFL_ENV);
    static options_t options;
    snprintf(options.folder, sizeof options.folder, "%s", argv[0]);
    char *slash = strrchr(options.folder, '/');
    snprintf(slash == NULL ? options.folder : slash, 3, "%s", slash == NULL ? "." : "");
    simulation_t simulation = {.system = system};
    simulation.members = calloc(system->target_count, sizeof *simulation.members);
    simulation.ways = calloc(system->connection_count + 1U, sizeof *simulation.ways);
    int status = FAILED;
    if (simulation.members != NULL && simulation.ways != NULL) {
        status = run(&simulation, &options, argc, argv);
        for (size_t i = 0; i < system->target_count; i++) {
            member_close(&simulation.members[i]);
            if (simulation.members[i].file != NULL && fclose(simulation.members[i].file) != 0) {
                status = FAILED;
            }
        }
    }
    plant_close(&simulation.plant);
    if (simulation.plant.file != NULL && fclose(simulation.plant.file) != 0) {
        status = FAILED;
    }
    if (simulation.topics != NULL && fclose(simulation.topics) != 0) {
        status = FAILED;
    }
    free(simulation.members);
    free(simulation.ways);
    free(simulation.failures);
    return status;
}
