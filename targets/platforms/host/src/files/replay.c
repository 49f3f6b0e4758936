/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Replay: the model computes again from the inputs of a recording, cycle by cycle.
 */
#include "replay.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "epg/finite.h"
#include "number.h"
#include "port/clock.h"
#include "program/options.h"
#include "trace.h"

/** Bytes of the longest line with its end and a zero; blanks and others that the console replaces in names. */
enum { LINE_SIZE = 65536 };
static const char replaced[] = " \t=<>,";

/** The state of a replay.  It is global for take_inputs(): functions of an application have no argument. */
static struct {
    const epg_host_target_t *host;
    const char *path;
    FILE *file;
    unsigned line;
    bool failed; /**< a mistake was reported */
    char text[LINE_SIZE];
    size_t columns;
    double **places; /**< for each column, the place of its number; NULL: it is not used.  On the heap */
    double time;
    double cycle;
    double *inputs; /**< of the row, one for each signal of the host that is an input of the model; on the heap */
    epg_application_t application;
    double before; /**< number of the cycle before; 0: the target was disabled */
    uint64_t replayed;
} replay;

#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
static bool
fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s:%u: error: ", replay.path, replay.line);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    replay.failed = true;
    return false;
}

static bool is_input(const epg_host_signal_t *signal)
{
    return strncmp(signal->name, "inputs.", 7) == 0;
}

/* Lines ---------------------------------------------------------------------------------------------------------- */

/** Reads a line without its end.  Returns false at the end of the file; a last line without an end was cut off. */
static bool next_line(void)
{
    if (fgets(replay.text, sizeof replay.text, replay.file) == NULL) {
        return false;
    }
    replay.line++;
    const size_t length = strlen(replay.text);
    if (length == 0 || replay.text[length - 1] != '\n') {
        return length == sizeof replay.text - 1 && fail("this line is too long");
    }
    replay.text[length - 1] = '\0';
    return true;
}

/** Cuts the text before the next comma off `*rest`, which becomes NULL after the last one. */
static char *next_field(char **rest)
{
    char *field = *rest;
    char *comma = strchr(field, ',');
    if (comma != NULL) {
        *comma = '\0';
    }
    *rest = comma != NULL ? comma + 1 : NULL;
    return field;
}

/** True if `name` is `column`, or would be it on the console, which replaces some characters. */
static bool is_named(const char *name, const char *column)
{
    while (*name != '\0' && (*name == *column || (*column == '_' && strchr(replaced, *name) != NULL))) {
        name++;
        column++;
    }
    return *name == '\0' && *column == '\0';
}

/** Finds the place of a column's numbers. */
static double *place_of(const char *column)
{
    if (strcmp(column, "time") == 0) {
        return &replay.time;
    }
    if (strcmp(column, "cycle") == 0) {
        return &replay.cycle;
    }
    for (size_t i = 0; i < replay.host->signal_count; i++) {
        if (is_input(&replay.host->signals[i]) && is_named(replay.host->signals[i].name, column)) {
            return &replay.inputs[i];
        }
    }
    return NULL;
}

static bool has_place(const double *place)
{
    for (size_t i = 0; i < replay.columns; i++) {
        if (replay.places[i] == place) {
            return true;
        }
    }
    return false;
}

/** Reads the names of the columns.  Returns false after a message. */
static bool read_header(void)
{
    if (!next_line() || strncmp(replay.text, "# epg recording 1 ", 18) != 0 || !next_line()) {
        return !replay.failed && fail("this file is not a recording of 'epg live --record'");
    }
    replay.columns = 1;
    for (const char *comma = strchr(replay.text, ','); comma != NULL; comma = strchr(comma + 1, ',')) {
        replay.columns++;
    }
    replay.places = calloc(replay.columns, sizeof *replay.places);
    if (replay.places == NULL) {
        return fail("not enough memory");
    }
    char *rest = replay.text;
    const char *last = "";
    for (size_t i = 0; rest != NULL; i++) {
        last = next_field(&rest);
        replay.places[i] = place_of(last);
    }
    if (strcmp(last, "changes") != 0 || !has_place(&replay.time) || !has_place(&replay.cycle)) {
        return fail("a recording has the columns time, cycle and, as the last one, changes");
    }
    for (size_t i = 0; i < replay.host->signal_count; i++) {
        if (is_input(&replay.host->signals[i]) && !has_place(&replay.inputs[i])) {
            return fail("the column '%s' is missing", replay.host->signals[i].name);
        }
    }
    return true;
}

/** Reads the numbers of a row.  `*changes` becomes its last field.  Returns false after a message. */
static bool read_row(char **changes)
{
    char *rest = replay.text;
    for (size_t i = 0; i + 1 < replay.columns; i++) {
        const char *field = next_field(&rest);
        double number = 0.0;
        if (rest == NULL) {
            return fail("this row has too few columns");
        }
        if (replay.places[i] == NULL) {
            continue;
        }
        if (!epg_host_parse_number(field, &number)) {
            return fail("'%s' is not a number", field);
        }
        *replay.places[i] = number;
    }
    *changes = rest;
    if (!(replay.time >= 0.0 && replay.time <= EPG_HOST_TIME_MAX)) {
        return fail("the time must be from 0 to 1e9 s");
    }
    return true;
}

/* Cycles --------------------------------------------------------------------------------------------------------- */

/** In place of the application's read(). */
static void take_inputs(void)
{
    for (size_t i = 0; i < replay.host->signal_count; i++) {
        if (is_input(&replay.host->signals[i])) {
            *(double *)replay.host->signals[i].value = replay.inputs[i]; /* the variables are not constants */
        }
    }
}

static void do_nothing(void)
{
}

/** The target's application, with the model and its parameters alone. */
static epg_application_t model_alone(const epg_application_t *whole)
{
    return (epg_application_t){
        .name = whole->name,
        .period_ns = whole->period_ns,
        .step_divider = whole->step_divider,
        .enable_at_start = true,
        .start = whole->start,
        .sample = do_nothing,
        .read = take_inputs,
        .inputs_finite = whole->inputs_finite,
        .model_init = whole->model_init,
        .model_step = whole->model_step,
        .model_finite = whole->model_finite,
        .model_stopped = whole->model_stopped,
        .write = do_nothing,
        .safe = do_nothing,
        .parameters = whole->parameters,
    };
}

/** The target is enabled: its first cycle initialises the model, which has the generated parameters. */
static void start(void)
{
    epg_parameters_t *parameters = replay.application.parameters;
    epg_control_start(replay.host->target->control, &replay.application);
    for (size_t i = 0; parameters != NULL && i < parameters->count; i++) {
        parameters->changed[i] = false;
    }
}

/** Requests the change `word`: "<parameter>=<number>".  Returns false after a message. */
static bool change(char *word)
{
    epg_parameters_t *parameters = replay.application.parameters;
    char *sign = strrchr(word, '=');
    double value = 0.0;
    if (sign == NULL || !epg_host_parse_number(sign + 1, &value) || !epg_is_finite(value)) {
        return fail("'%s' is not a change of a parameter", word);
    }
    *sign = '\0';
    for (size_t i = 0; parameters != NULL && i < parameters->count; i++) {
        if (strcmp(parameters->table[i].name, word) == 0) {
            epg_parameters_prepare(parameters, i, value);
            return true;
        }
    }
    fail("this program has no parameter '%s' that can be changed", word);
    if (parameters == NULL) {
        fputs("hint: its target needs the console: 'console: true' in 'communication' of the .tcf\n", stderr);
    }
    return false;
}

/** Requests all changes of a cycle.  Returns false after a message. */
static bool make_changes(char *changes)
{
    bool any = false;
    for (char *word = strtok(changes, " "); word != NULL; word = strtok(NULL, " ")) {
        any = true;
        if (!change(word)) {
            return false;
        }
    }
    if (any) {
        epg_parameters_request(replay.application.parameters);
    }
    return true;
}

/** Runs the control cycle of the row.  A debugger can stop here: `replay.cycle` is the number of the cycle. */
static void epg_host_replay_cycle(epg_host_trace_t *trace)
{
    const uint64_t tick_ns = (uint64_t)(replay.time * 1e9 + 0.5);
    epg_host_clock_simulate(tick_ns);
    epg_control_cycle(replay.host->target->control, tick_ns, 0);
    epg_host_trace_add(trace, tick_ns, 0, 0);
    replay.replayed++;
}

/** Replays the row.  Returns false after a message. */
static bool replay_row(epg_host_trace_t *trace)
{
    char *changes = NULL;
    if (!read_row(&changes)) {
        return false;
    }
    if (replay.cycle > 0.0) {
        if (replay.cycle != 1.0 && replay.cycle != replay.before + 1.0) {
            return fail("cycle %.0f must not follow cycle %.0f", replay.cycle, replay.before);
        }
        if (replay.cycle == 1.0) {
            start();
        }
        if (!make_changes(changes)) {
            return false;
        }
        epg_host_replay_cycle(trace);
    }
    replay.before = replay.cycle;
    return true;
}

static bool replay_rows(FILE *file)
{
    epg_host_trace_t trace;
    if (!read_header() || !epg_host_trace_start(&trace, replay.host, file, false, UINT64_MAX)) {
        return false;
    }
    while (next_line() && replay_row(&trace)) {
    }
    epg_host_trace_end(&trace);
    epg_host_clock_real();
    return !replay.failed;
}

int epg_host_replay(const epg_host_target_t *host, const char *path, FILE *trace, bool quiet)
{
    replay.host = host;
    replay.path = path;
    replay.application = model_alone(host->target->application);
    replay.inputs = calloc(host->signal_count + 1, sizeof *replay.inputs);
    replay.file = fopen(path, "rb");
    bool good = false;
    if (replay.file == NULL) {
        fprintf(stderr, "%s: error: cannot read this file: %s\n", path, strerror(errno));
    } else if (replay.inputs == NULL) {
        fail("not enough memory");
    } else {
        good = replay_rows(trace);
    }
    if (replay.file != NULL) {
        fclose(replay.file);
    }
    free(replay.places);
    free(replay.inputs);
    if (good && !quiet) {
        printf("%s: %" PRIu64 " cycles replayed\n", host->target->application->name, replay.replayed);
    }
    return good ? DONE : WRONG_INPUT;
}
