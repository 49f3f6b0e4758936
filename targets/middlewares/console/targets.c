/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The commands that act on the target: setpoints, enable, disable, jog; and echo.
 */
#include <string.h>

#include "session.h"

/** Returns true if the command has `count` words, otherwise reports `usage`. */
static bool has_words(epg_console_session_t *session, const epg_console_command_t *command, size_t count,
                      const char *usage)
{
    if (command->count != count) {
        epg_console_error(session, command->words[0], usage, NULL);
    }
    return command->count == count;
}

void epg_console_enable(epg_console_session_t *session, const epg_console_command_t *command)
{
    const bool leased = command->count == 2 && strcmp(command->words[1], "leased") == 0;
    if (leased && !session->output.framed) {
        epg_console_error(session, "enable", "a lease is for programs that use frames", NULL);
    } else if (leased && session->has_status && session->status.enabled && !session->status.leased) {
        epg_console_error(session, "enable", "the target is enabled already, without a lease", NULL);
    } else if (leased || has_words(session, command, 1, "must be the only word")) {
        if (leased) {
            epg_console_enable_leased(session);
        } else {
            epg_control_request(session->target->control, true);
        }
        epg_console_wait_for(session, "enable", EPG_CONSOLE_ENABLING);
    }
}

void epg_console_disable(epg_console_session_t *session, const epg_console_command_t *command)
{
    /* Disabling must act even if the line has more words. */
    (void)command;
    epg_control_request(session->target->control, false);
    epg_console_wait_for(session, "disable", EPG_CONSOLE_DISABLING);
}

void epg_console_echo(epg_console_session_t *session, const epg_console_command_t *command)
{
    const bool on = command->count == 2 && strcmp(command->words[1], "on") == 0;
    if (!on && (command->count != 2 || strcmp(command->words[1], "off") != 0)) {
        epg_console_error(session, "echo", "must be 'on' or 'off'", NULL);
        return;
    }
    session->input.echo = on;
    epg_console_done(session, "echo");
}

/* Setpoints ---------------------------------------------------------------------------------------------------- */

/** Returns the index of the setpoint with this name; SIZE_MAX if there is none. */
static size_t find_setpoint(const epg_target_t *target, const char *name)
{
    for (size_t i = 0; i < target->subscription_count; i++) {
        const size_t value = epg_console_find_value(&target->subscriptions[i], name);
        if (value != SIZE_MAX) {
            return target->subscriptions[i].index + value;
        }
    }
    return SIZE_MAX;
}

void epg_console_setpoints(epg_console_session_t *session, const epg_console_command_t *command)
{
    size_t indices[EPG_CONSOLE_WORDS];
    double values[EPG_CONSOLE_WORDS];
    for (size_t i = 0; i < command->count; i++) {
        const char *text;
        epg_console_assignment(command->words[i], &text);
        indices[i] = find_setpoint(session->target, command->words[i]);
        if (indices[i] == SIZE_MAX) {
            epg_console_error(session, "setpoint", "there is no setpoint", command->words[i]);
            return;
        }
        if (text == NULL || !epg_console_number(text, &values[i])) {
            epg_console_error(session, "setpoint", "this is not a number:", text == NULL ? "" : text);
            return;
        }
    }
    for (size_t i = 0; i < command->count; i++) {
        epg_control_receive(session->target->control, indices[i], values[i], session->now_ns, i + 1 == command->count);
    }
    epg_console_done(session, "setpoint");
}

/* Jog ---------------------------------------------------------------------------------------------------------- */

static size_t find_actuator(const epg_jog_t *jog, const char *name)
{
    for (size_t i = 0; i < jog->actuator_count; i++) {
        if (strcmp(jog->actuators[i].name, name) == 0) {
            return i;
        }
    }
    return SIZE_MAX;
}

void epg_console_jog(epg_console_session_t *session, const epg_console_command_t *command)
{
    epg_jog_t *jog = session->target->application->jog;
    const epg_console_options_t *options = session->options;
    if (jog == NULL || options->jog_duty <= 0.0) {
        epg_console_error(session, "jog", "this target has no jog", NULL);
        return;
    }
    if (!has_words(session, command, 4, "use jog <actuator> <duty> <ms>")) {
        return;
    }
    const size_t index = find_actuator(jog, command->words[1]);
    double duty;
    uint32_t time_ms;
    if (index == SIZE_MAX) {
        epg_console_error(session, "jog", "there is no actuator", command->words[1]);
    } else if (!epg_console_number(command->words[2], &duty)) {
        epg_console_error(session, "jog", "this is not a number:", command->words[2]);
    } else if (duty > options->jog_duty || duty < -options->jog_duty) {
        epg_console_begin(&session->output, "error jog the duty must be at most ");
        epg_console_double(&session->output, options->jog_duty);
        epg_console_text(&session->output, " for this target");
        epg_console_end_or_drop(&session->output);
    } else if (!epg_console_whole(command->words[3], (uint32_t)(options->jog_time_ns / 1000000U), &time_ms) ||
               time_ms == 0) {
        epg_console_begin(&session->output, "error jog the time must be from 1 to ");
        epg_console_integer(&session->output, (int64_t)(options->jog_time_ns / 1000000U));
        epg_console_text(&session->output, " ms for this target");
        epg_console_end_or_drop(&session->output);
    } else if (session->has_status && session->status.enabled) {
        epg_console_error(session, "jog", "the target is enabled: disable it", NULL);
    } else if (session->jogging && session->output.framed && epg_jog_renew(jog, index, duty)) {
        epg_console_done(session, "jog");
    } else if (session->jogging) {
        epg_console_error(session, "jog", "an actuator is moving", NULL);
    } else {
        const uint64_t period_ns = session->target->application->period_ns;
        const uint64_t cycles = ((uint64_t)time_ms * 1000000U + period_ns / 2U) / period_ns;
        session->live.jog_tag = session->output.tag;
        session->jogging = epg_jog_start(jog, index, duty, cycles == 0 ? 1U : (uint32_t)cycles);
        if (!session->jogging) {
            epg_console_error(session, "jog", "an actuator is moving", NULL);
        }
    }
}

/** Appends a number that always has a sign, because the user must see the direction. */
static void put_signed(epg_console_output_t *output, const char *name, double value)
{
    epg_console_key(output, name);
    if (value > 0.0) {
        epg_console_text(output, "+");
    }
    epg_console_double(output, value);
}

static bool moved_line(epg_console_session_t *session, size_t index)
{
    const epg_jog_t *jog = session->target->application->jog;
    if (index >= jog->encoder_count) {
        return false;
    }
    const epg_jog_reading_t *first = &jog->first[index];
    const epg_jog_reading_t *last = &jog->last[index];
    epg_console_begin(&session->output, "moved ");
    epg_console_text(&session->output, jog->encoders[index].name);
    put_signed(&session->output, "count", (double)(last->count - first->count));
    put_signed(&session->output, "position", last->position - first->position);
    epg_console_unit(&session->output, jog->encoders[index].unit);
    return true;
}

void epg_console_poll_jog(epg_console_session_t *session)
{
    epg_jog_t *jog = session->target->application->jog;
    if (!session->jogging || session->list != NULL || !epg_jog_idle(jog)) {
        return;
    }
    session->jogging = false;
    switch (jog->end) {
    case EPG_JOG_DONE:
        epg_console_answer(session, "jog", moved_line);
        break;
    case EPG_JOG_REFUSED:
        epg_console_error(session, "jog", "refused: the target is enabled, or its fail-safe input is inactive", NULL);
        break;
    case EPG_JOG_STOPPED:
        epg_console_error(session, "jog", "stopped by a request or a fault", NULL);
        break;
    }
}
