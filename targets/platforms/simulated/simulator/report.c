/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What programs are told about a simulation: the names of its targets, and their states at its end.
 */
#include "report.h"

#include <inttypes.h>

#include "files/number.h"
#include "program/interface.h"

static const char *const states[] = {
    [MEMBER_RUNS] = "runs",
    [MEMBER_HANGS] = "hangs",
    [MEMBER_IS_DEAD] = "dead",
};

static void print_values(const epg_topic_t *topic)
{
    for (size_t i = 0; i < topic->count; i++) {
        printf("connected,%s\n", epg_topic_value_name(topic, i));
    }
}

/** Prints the signals of the system's plant. */
static void print_ports(const char *side, size_t count, const epg_system_port_t *ports)
{
    for (size_t i = 0; i < count; i++) {
        printf("signal,plant.%s.%s\n", side, ports[i].name);
    }
}

void report_interface(const simulation_t *simulation)
{
    const epg_system_t *system = simulation->system;
    printf("system,%s\n", system->name);
    if (system->plant != NULL) {
        print_ports("inputs", system->plant->input_count, system->plant->inputs);
        print_ports("outputs", system->plant->output_count, system->plant->outputs);
    }
    for (size_t i = 0; i < system->target_count; i++) {
        const epg_host_target_t *host = simulation->members[i].unit->host;
        printf("target,%s\n", system->targets[i].name);
        epg_host_print_interface(host);
        for (size_t k = 0; k < system->connection_count; k++) {
            const epg_system_connection_t *connection = &system->connections[k];
            if (connection->receiver == i) {
                print_values(&host->target->subscriptions[connection->subscription]);
            }
        }
    }
}

static void write_target(const member_t *member, FILE *file)
{
    const epg_target_t *target = member->unit->host->target;
    const epg_control_t *control = target->control;
    const epg_statistics_t *statistics = &control->statistics;
    fprintf(file, "    \"%s\": {\"state\": \"%s\", \"period\": ", member->facts->name, states[member->state]);
    epg_host_write_number(file, epg_host_seconds(target->application->period_ns));
    fprintf(file, ", \"cycles\": %" PRIu32 ", \"clamped\": %" PRIu32, statistics->cycles, statistics->clamped);
    fprintf(file, ", \"setpoints_dropped\": %" PRIu32, (uint32_t)atomic_load(&control->dropped));
    fprintf(file, ", \"setpoint_timeouts\": %" PRIu32, statistics->setpoint_timeouts);
    fprintf(file, ", \"faults\": %" PRIu32 ", \"enabled\": %s", statistics->faults,
            control->enabled ? "true" : "false");
    fprintf(file, ", \"fault\": \"%s\", \"fault_component\": \"%s\"}", epg_target_fault(target, control->fault),
            epg_target_component(target, control->fault_component));
}

void report_statistics(const simulation_t *simulation, FILE *file)
{
    const epg_system_t *system = simulation->system;
    fprintf(file, "{\n  \"name\": \"%s\",\n  \"mode\": \"simulated\",\n  \"duration\": ", system->name);
    epg_host_write_number(file, epg_host_seconds(simulation->end_ns));
    fputs(",\n  \"targets\": {\n", file);
    for (size_t i = 0; i < system->target_count; i++) {
        write_target(&simulation->members[i], file);
        fputs(i + 1U < system->target_count ? ",\n" : "\n", file);
    }
    fputs("  }", file);
    if (system->plant != NULL) {
        fputs(",\n  \"plant\": {", file);
        plant_write_outputs(&simulation->plant, file);
        fputs("}", file);
    }
    fputs("\n}\n", file);
}
