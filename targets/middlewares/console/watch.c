/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The command watch: values at the communication period.  All values of a line belong to one control cycle.
 */
#include <string.h>

#include "console.h"
#include "session.h"

/** Returns the value index of a publication or signal; SIZE_MAX if there is none with this name. */
static size_t find(const epg_console_session_t *session, const char *name)
{
    const epg_target_t *target = session->target;
    for (size_t i = 0; i < target->publication_count; i++) {
        const size_t value = epg_console_find_value(&target->publications[i], name);
        if (value != SIZE_MAX) {
            return target->publications[i].index + value;
        }
    }
    const size_t signal = epg_console_find_signal(session, name);
    return signal == SIZE_MAX ? SIZE_MAX : target->signals[signal].index;
}

/** Returns the name of a monitoring value.  `*publication` is the publication whose first value it is, or SIZE_MAX. */
static const char *name_of(const epg_target_t *target, size_t index, size_t *publication)
{
    *publication = SIZE_MAX;
    for (size_t i = 0; i < target->publication_count; i++) {
        const epg_topic_t *topic = &target->publications[i];
        if (topic->role == EPG_TOPIC_VALUES && index >= topic->index && index - topic->index < topic->count) {
            *publication = index == topic->index ? i : SIZE_MAX;
            return epg_topic_value_name(topic, index - topic->index);
        }
    }
    for (size_t i = 0; i < target->signal_count; i++) {
        if (target->signals[i].index == index) {
            return target->signals[i].name;
        }
    }
    return "?";
}

static void watch_value(epg_console_session_t *session, size_t index)
{
    if (session->watched_count < EPG_CONSOLE_WATCHED) {
        session->watched[session->watched_count++] = index;
    }
}

/** Watches all published values, or all signals if there are no publications. */
static void watch_all(epg_console_session_t *session)
{
    const epg_target_t *target = session->target;
    session->watched_count = 0;
    for (size_t i = 0; i < target->publication_count; i++) {
        const epg_topic_t *topic = &target->publications[i];
        for (size_t k = 0; topic->role == EPG_TOPIC_VALUES && k < topic->count; k++) {
            watch_value(session, topic->index + k);
        }
    }
    const bool published = session->watched_count > 0;
    for (size_t i = 0; !published && i < target->signal_count; i++) {
        watch_value(session, target->signals[i].index);
    }
}

void epg_console_watch(epg_console_session_t *session, const epg_console_command_t *command)
{
    const bool off = command->count == 2 && strcmp(command->words[1], "off") == 0;
    size_t chosen[EPG_CONSOLE_WORDS];
    for (size_t i = 1; i < command->count && !off; i++) {
        chosen[i - 1U] = find(session, command->words[i]);
        if (chosen[i - 1U] == SIZE_MAX) {
            epg_console_error(session, "watch", "there is no port", command->words[i]);
            return;
        }
    }
    if (command->count == 1) {
        watch_all(session);
    } else if (!off) {
        session->watched_count = command->count - 1U;
        memcpy(session->watched, chosen, session->watched_count * sizeof chosen[0]);
    }
    session->watching = !off;
    session->watch_next_ns = session->now_ns;
    session->watch_shown_ns = UINT64_MAX;
    epg_console_done(session, "watch");
}

void epg_console_poll_watch(epg_console_session_t *session)
{
    const epg_target_t *target = session->target;
    if (!session->watching || session->now_ns < session->watch_next_ns) {
        return;
    }
    /* The schedule is fixed: a late line does not delay the next ones, and missed lines are not written later. */
    const uint64_t period_ns = target->communication_period_ns;
    session->watch_next_ns += ((session->now_ns - session->watch_next_ns) / period_ns + 1U) * period_ns;
    const double *values = session->options->values;
    uint64_t time_ns;
    if (!epg_control_monitor(target->control, session->options->values)) {
        return;
    }
    memcpy(&time_ns, &values[target->time_index], sizeof time_ns);
    if (time_ns == session->watch_shown_ns) {
        return; /* the model is stopped: there are no new values */
    }
    session->watch_shown_ns = time_ns;
    epg_console_begin(&session->output, "watch ");
    epg_console_seconds(&session->output, epg_console_since_start(session, time_ns));
    for (size_t i = 0; i < session->watched_count; i++) {
        size_t publication;
        const char *name = name_of(target, session->watched[i], &publication);
        if (publication != SIZE_MAX) {
            epg_target_publishing(target, publication);
        }
        epg_console_value(&session->output, name, values[session->watched[i]]);
    }
    epg_console_end_or_drop(&session->output);
}
