/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Reader of the setpoint file.
 */
#include "setpoints.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/finite.h"
#include "epg/plant.h"
#include "number.h"

/** Number of fields in a row, and bytes of the longest row with its end and a zero.  The rest of it would be a row. */
enum { FIELDS = 3, LINE_SIZE = 1024 };

static const char header[] = "time,topic,value";

/** The state of the reader, while it reads one file. */
typedef struct reader {
    const char *path;
    const epg_host_target_t *host;
    bool realtime;
    unsigned line;
    uint64_t previous_ns;
} reader_t;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static bool
fail(const reader_t *reader, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s:%u: error: ", reader->path, reader->line);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    return false;
}

static char *trim(char *text)
{
    text += strspn(text, " \t");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r\n", text[length - 1]) != NULL) {
        length--;
    }
    text[length] = '\0';
    return text;
}

/** Splits `line` at its commas.  Puts the first FIELDS fields into `fields`, and returns the number of all fields. */
static size_t split(char *line, char *fields[FIELDS])
{
    size_t count = 0;
    while (line != NULL) {
        char *comma = strchr(line, ',');
        if (comma != NULL) {
            *comma = '\0';
        }
        if (count < FIELDS) {
            fields[count] = trim(line);
        }
        count++;
        line = comma == NULL ? NULL : comma + 1;
    }
    return count;
}

/** Reports an unknown topic, with the names of all subscriptions as the hint. */
static bool fail_topic(const reader_t *reader, const char *topic)
{
    const epg_target_t *target = reader->host->target;
    fail(reader, "unknown topic '%s'", topic);
    fputs("hint: the target subscribes to ", stderr);
    for (size_t i = 0; i < target->subscription_count; i++) {
        const epg_topic_t *subscription = &target->subscriptions[i];
        for (size_t k = 0; k < subscription->count; k++) {
            fprintf(stderr, "'%s', ", epg_topic_value_name(subscription, k));
        }
    }
    fputs("and has '$enable', '$component:<name>' and '$stall'\n", stderr);
    return false;
}

static bool fail_component(const reader_t *reader, const char *name)
{
    const epg_host_target_t *host = reader->host;
    fail(reader, "the target has no digital input '%s'", name);
    fputs(host->input_count > 0 ? "hint: its digital inputs: " : "hint: it has no digital inputs", stderr);
    for (size_t i = 0; i < host->input_count; i++) {
        fprintf(stderr, "%s'%s'", i > 0 ? ", " : "", host->inputs[i].name);
    }
    fputc('\n', stderr);
    return false;
}

static const epg_host_input_t *find_input(const reader_t *reader, const char *name)
{
    for (size_t i = 0; i < reader->host->input_count; i++) {
        if (strcmp(reader->host->inputs[i].name, name) == 0) {
            return &reader->host->inputs[i];
        }
    }
    return NULL;
}

/** Reads a row with `$component:<name>`: the level of a digital input, in place of the plant's. */
static bool read_force(const reader_t *reader, const char *name, const char *text, epg_host_event_t *event)
{
    const epg_host_input_t *input = find_input(reader, name);
    double level = 0.0;
    epg_plant_force_t force = EPG_PLANT_FORCE_NONE;
    if (input == NULL) {
        return fail_component(reader, name);
    }
    if (strcmp(text, "open") == 0) {
        force = EPG_PLANT_FORCE_OPEN;
    } else if (strcmp(text, "plant") != 0) {
        if (!epg_host_parse_number(text, &level) || (level != 0.0 && level != 1.0)) {
            return fail(reader, "'%s' must be one of 0, 1, open, plant", text);
        }
        force = (level > 0.5) != input->invert ? EPG_PLANT_FORCE_HIGH : EPG_PLANT_FORCE_LOW;
    }
    event->kind = EPG_HOST_INPUT;
    event->index = input->pin;
    event->value = (double)force;
    return true;
}

/** Finds the kind and the index of the event that a row with `topic` describes. */
static bool read_topic(const reader_t *reader, const char *topic, epg_host_event_t *event)
{
    const epg_target_t *target = reader->host->target;
    for (size_t i = 0; i < target->subscription_count; i++) {
        const epg_topic_t *subscription = &target->subscriptions[i];
        for (size_t k = 0; k < subscription->count; k++) {
            if (strcmp(topic, epg_topic_value_name(subscription, k)) == 0) {
                event->kind = subscription->role == EPG_TOPIC_ENABLE ? EPG_HOST_ENABLE : EPG_HOST_SETPOINT;
                event->index = subscription->index + k;
                return true;
            }
        }
    }
    if (strcmp(topic, "$enable") == 0) {
        event->kind = EPG_HOST_ENABLE;
        return true;
    }
    if (strcmp(topic, "$stall") == 0) {
        event->kind = EPG_HOST_STALL;
        return reader->realtime ? fail(reader, "'$stall' works in simulated time only") : true;
    }
    return fail_topic(reader, topic);
}

static bool read_value(const reader_t *reader, const char *text, epg_host_event_t *event)
{
    uint64_t stall_ns = 0;
    if (!epg_host_parse_number(text, &event->value)) {
        return fail(reader, "'%s' is not a number", text);
    }
    switch (event->kind) {
    case EPG_HOST_ENABLE:
        return event->value == 0.0 || event->value == 1.0 ? true : fail(reader, "'%s' must be 0 or 1", text);
    case EPG_HOST_STALL:
        return epg_host_parse_time(text, &stall_ns) ? true : fail(reader, "'%s' is not a time in seconds", text);
    case EPG_HOST_SETPOINT:
    case EPG_HOST_INPUT:
    default:
        return true;
    }
}

static bool read_event(reader_t *reader, char *line, epg_host_event_t *event)
{
    char *fields[FIELDS] = {NULL, NULL, NULL};
    const size_t count = split(line, fields);
    if (count != FIELDS) {
        return fail(reader, "this row has %u field%s: it must have the form '%s'", (unsigned)count,
                    count == 1 ? "" : "s", header);
    }
    if (!epg_host_parse_time(fields[0], &event->time_ns)) {
        return fail(reader, "'%s' is not a time in seconds", fields[0]);
    }
    if (event->time_ns < reader->previous_ns) {
        return fail(reader, "time %s is earlier than in the row above", fields[0]);
    }
    reader->previous_ns = event->time_ns;
    static const char component[] = "$component:";
    if (strncmp(fields[1], component, strlen(component)) == 0) {
        return read_force(reader, fields[1] + strlen(component), fields[2], event);
    }
    return read_topic(reader, fields[1], event) && read_value(reader, fields[2], event);
}

/**
 * Setpoints with the same time must arrive at the model together: only the last one is marked to publish all of them.
 * A value that is not finite is dropped later, so it must not be that one.
 */
static void mark_published(epg_host_events_t *events)
{
    const epg_host_event_t *later = NULL;
    for (size_t i = events->count; i > 0; i--) {
        epg_host_event_t *event = &events->events[i - 1];
        if (event->kind == EPG_HOST_SETPOINT && epg_is_finite(event->value)) {
            event->publish = later == NULL || later->time_ns != event->time_ns;
            later = event;
        }
    }
}

/** Adds an event to the list, whose memory is doubled whenever the count has reached a power of two. */
static bool add(epg_host_events_t *events, const epg_host_event_t *event)
{
    if ((events->count & (events->count - 1)) == 0) {
        const size_t capacity = events->count == 0 ? 1 : 2 * events->count;
        epg_host_event_t *larger = realloc(events->events, capacity * sizeof *larger);
        if (larger == NULL) {
            fputs("error: not enough memory for the setpoints\n", stderr);
            return false;
        }
        events->events = larger;
    }
    events->events[events->count++] = *event;
    return true;
}

static char *next_line(reader_t *reader, FILE *file, char line[LINE_SIZE])
{
    reader->line++;
    return fgets(line, LINE_SIZE, file) == NULL ? NULL : trim(line);
}

/** Reads up to the end of the file, or until it cannot be read.  Returns false at the first mistake in it. */
static bool read_lines(reader_t *reader, FILE *file, epg_host_events_t *events)
{
    static const char byte_order_mark[] = "\xef\xbb\xbf";
    char line[LINE_SIZE];
    char *text = next_line(reader, file, line);
    if (text != NULL && strncmp(text, byte_order_mark, 3) == 0) {
        text += 3;
    }
    if (ferror(file) == 0 && (text == NULL || strcmp(text, header) != 0)) {
        return fail(reader, "the first line must be '%s'", header);
    }
    while ((text = next_line(reader, file, line)) != NULL) {
        epg_host_event_t event = {0};
        if (text[0] != '\0' && !(read_event(reader, text, &event) && add(events, &event))) {
            return false;
        }
    }
    return true;
}

bool epg_host_read_setpoints(const char *path, const epg_host_target_t *host, bool realtime, epg_host_events_t *events)
{
    *events = (epg_host_events_t){0};
    reader_t reader = {.path = path, .host = host, .realtime = realtime};
    FILE *file = fopen(path, "rb");
    bool good = file != NULL && read_lines(&reader, file, events);
    if (file == NULL || ferror(file) != 0) { /* a folder can be opened but not read */
        fprintf(stderr, "%s: error: cannot read the setpoint file: %s\n", path, strerror(errno));
        good = false;
    }
    if (file != NULL) {
        fclose(file);
    }
    if (!good) {
        epg_host_free_setpoints(events);
        return false;
    }
    mark_published(events);
    return true;
}

void epg_host_free_setpoints(epg_host_events_t *events)
{
    free(events->events);
    *events = (epg_host_events_t){0};
}
