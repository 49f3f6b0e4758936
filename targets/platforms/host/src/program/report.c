/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The report about a run after its end: statistics as JSON, and a summary.
 */
#include "report.h"

#include <inttypes.h>
#include <string.h>

#include "epg/fault.h"
#include "files/number.h"

/** Upper edges of the histogram's bins in nanoseconds: 1, 2 and 5 in each decade. */
static const uint64_t edges[] = {1000,    2000,    5000,    10000,    20000,    50000,    100000,    200000,    500000,
                                 1000000, 2000000, 5000000, 10000000, 20000000, 50000000, 100000000, UINT64_MAX};
enum { EDGES = sizeof edges / sizeof edges[0] };

static uint64_t in_bin(const epg_host_run_t *run, size_t bin)
{
    return epg_host_histogram_between(&run->timing.lateness, bin == 0 ? 0 : edges[bin - 1], edges[bin]);
}

/** The target's statistics after the last cycle, with the ticks that were missed after it. */
static epg_statistics_t counts(const epg_host_run_t *run)
{
    const epg_control_t *control = run->host->target->control;
    epg_statistics_t statistics = control->statistics;
    statistics.missed += (uint32_t)run->missed_at_end;
    statistics.setpoints_dropped = atomic_load(&control->dropped); /* includes later ones */
    return statistics;
}

/* JSON --------------------------------------------------------------------------------------------------------- */

/** Writes `value`, which has no quotes and no backslashes: it is a word of the program or a name. */
static void write_word(FILE *file, const char *key, const char *value)
{
    fprintf(file, "  \"%s\": \"%s\",\n", key, value);
}

static void write_count(FILE *file, const char *key, uint64_t value)
{
    fprintf(file, "  \"%s\": %" PRIu64 ",\n", key, value);
}

static void write_flag(FILE *file, const char *key, bool value)
{
    fprintf(file, "  \"%s\": %s,\n", key, value ? "true" : "false");
}

/** Writes `value`, which is in nanoseconds, in seconds. */
static void write_time(FILE *file, const char *key, double value)
{
    fprintf(file, "  \"%s\": ", key);
    epg_host_write_number(file, value / 1e9);
    fputs(",\n", file);
}

static void write_histogram(FILE *file, const epg_host_run_t *run)
{
    fputs("  \"lateness_histogram\": [", file);
    const char *separator = "";
    for (size_t bin = 0; bin < EDGES; bin++) {
        const uint64_t count = in_bin(run, bin);
        if (count > 0) {
            fprintf(file, "%s{\"below\": ", separator);
            if (edges[bin] == UINT64_MAX) {
                fputs("null", file);
            } else {
                epg_host_write_number(file, epg_host_seconds(edges[bin]));
            }
            fprintf(file, ", \"count\": %" PRIu64 "}", count);
            separator = ", ";
        }
    }
    fputs("]\n", file);
}

void epg_host_write_statistics(FILE *file, const epg_host_run_t *run)
{
    const epg_target_t *target = run->host->target;
    const epg_host_timing_t *timing = &run->timing;
    const epg_statistics_t statistics = counts(run);
    fputs("{\n", file);
    write_word(file, "name", target->application->name);
    write_word(file, "mode", strcmp(run->scheduler, "simulated") == 0 ? "simulated" : "realtime");
    if (run->pace > 0.0) {
        fputs("  \"pace\": ", file);
        epg_host_write_number(file, run->pace);
        fputs(",\n", file);
    }
    write_word(file, "scheduler", run->scheduler);
    write_flag(file, "memory_locked", run->memory_locked);
    write_time(file, "period", (double)target->application->period_ns);
    write_time(file, "duration", (double)run->ran_ns);
    write_time(file, "wall_time", (double)run->wall_time_ns);
    write_flag(file, "interrupted", epg_host_interrupted != 0);
    write_count(file, "cycles", statistics.cycles);
    write_count(file, "overruns", statistics.overruns);
    write_count(file, "missed", statistics.missed);
    write_count(file, "outputs_late", statistics.outputs_late);
    write_time(file, "lateness_min", (double)timing->lateness.min);
    write_time(file, "lateness_mean", epg_host_histogram_mean(&timing->lateness));
    write_time(file, "lateness_p99", (double)epg_host_histogram_quantile(&timing->lateness, 0.99));
    write_time(file, "lateness_p999", (double)epg_host_histogram_quantile(&timing->lateness, 0.999));
    write_time(file, "lateness_max", (double)timing->lateness.max);
    write_time(file, "interval_deviation_min", (double)timing->deviation_min);
    write_time(file, "interval_deviation_rms", epg_host_timing_deviation_rms(timing));
    write_time(file, "interval_deviation_max", (double)timing->deviation_max);
    write_time(file, "computation_min", (double)timing->computation.min);
    write_time(file, "computation_mean", epg_host_histogram_mean(&timing->computation));
    write_time(file, "computation_max", (double)timing->computation.max);
    write_count(file, "trace_dropped", run->trace.dropped);
    write_count(file, "clamped", statistics.clamped);
    write_count(file, "setpoints_dropped", statistics.setpoints_dropped);
    write_count(file, "setpoint_timeouts", statistics.setpoint_timeouts);
    write_count(file, "faults", statistics.faults);
    write_flag(file, "enabled", target->control->enabled);
    write_word(file, "fault", epg_target_fault(target, target->control->fault));
    write_word(file, "fault_component", epg_target_component(target, target->control->fault_component));
    write_histogram(file, run);
    fputs("}\n", file);
}

/* Summary ------------------------------------------------------------------------------------------------------- */

static void print_histogram(const epg_host_run_t *run)
{
    static const char bar[] = "########################################"; /* 40 */
    const uint64_t total = run->timing.lateness.count;
    for (size_t bin = 0; bin < EDGES; bin++) {
        const uint64_t count = in_bin(run, bin);
        if (count == 0) {
            continue;
        }
        const int length = (int)((count * (sizeof bar - 1) + total - 1) / total);
        if (edges[bin] == UINT64_MAX) {
            printf("    above %6.0f us %10" PRIu64 "  %.*s\n", (double)edges[bin - 1] / 1e3, count, length, bar);
        } else {
            printf("    below %6.0f us %10" PRIu64 "  %.*s\n", (double)edges[bin] / 1e3, count, length, bar);
        }
    }
}

static void print_realtime(const epg_host_run_t *run)
{
    const epg_host_timing_t *timing = &run->timing;
    printf("  interval     deviation %.1f ... %.1f us, rms %.1f us\n", (double)timing->deviation_min / 1e3,
           (double)timing->deviation_max / 1e3, epg_host_timing_deviation_rms(timing) / 1e3);
    printf("  scheduler    %s%s%s%s, memory %s\n", run->scheduler,
           run->scheduler_reason == NULL ? "" : " (SCHED_FIFO refused: ",
           run->scheduler_reason == NULL ? "" : run->scheduler_reason, run->scheduler_reason == NULL ? "" : ")",
           run->memory_locked ? "locked" : "not locked");
    puts("  lateness");
    print_histogram(run);
}

void epg_host_print_summary(const epg_host_run_t *run)
{
    const epg_target_t *target = run->host->target;
    const epg_host_timing_t *timing = &run->timing;
    const epg_statistics_t statistics = counts(run);
    const bool realtime = strcmp(run->scheduler, "simulated") != 0;
    const double duration = epg_host_seconds(run->ran_ns);
    const double wall_time = epg_host_seconds(run->wall_time_ns);
    printf("%s: %.3f s %s, wall time %.3f s%s\n", target->application->name, duration,
           realtime ? "in real time" : "simulated", wall_time, epg_host_interrupted ? ", interrupted" : "");
    printf("  cycles       %" PRIu32 ", overruns %" PRIu32 ", missed %" PRIu32 "\n", statistics.cycles,
           statistics.overruns, statistics.missed);
    printf("  lateness     min %.1f, mean %.1f, 99%% %.1f, 99.9%% %.1f, max %.1f us\n",
           (double)timing->lateness.min / 1e3, epg_host_histogram_mean(&timing->lateness) / 1e3,
           (double)epg_host_histogram_quantile(&timing->lateness, 0.99) / 1e3,
           (double)epg_host_histogram_quantile(&timing->lateness, 0.999) / 1e3, (double)timing->lateness.max / 1e3);
    printf("  computation  min %.1f, mean %.1f, max %.1f us\n", (double)timing->computation.min / 1e3,
           epg_host_histogram_mean(&timing->computation) / 1e3, (double)timing->computation.max / 1e3);
    if (realtime) {
        print_realtime(run);
    }
    printf("  values       clamped %" PRIu32 ", setpoints dropped %" PRIu32 ", setpoint timeouts %" PRIu32 "\n",
           statistics.clamped, statistics.setpoints_dropped, statistics.setpoint_timeouts);
    const char *component = epg_target_component(target, target->control->fault_component);
    printf("  state        %s, faults %" PRIu32 ", fault: %s%s%s%s\n",
           target->control->enabled ? "enabled" : "disabled", statistics.faults,
           epg_target_fault(target, target->control->fault), component[0] != '\0' ? " (" : "", component,
           component[0] != '\0' ? ")" : "");
}
