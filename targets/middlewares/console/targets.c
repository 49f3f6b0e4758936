/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The commands that act on the target: setpoints, enable, disable, jog; and echo.
 */
#include <string.h>

#include "console.h"
#include "session.h"

/** Reads the number of a stop, such as "9f3c12ab-4". */
static bool read_stop_number(const char *text, uint64_t *number)
{
    uint32_t boot = 0;
    uint32_t count;
    for (int i = 0; i < 8; i++) {
        const char *digits = "0123456789abcdef";
        const char *digit = text[i] == '\0' ? NULL : strchr(digits, text[i]);
        if (digit == NULL) {
            return false;
        }
        boot = boot << 4U | (uint32_t)(digit - digits);
    }
    *number = 0;
    if (text[8] != '-' || !epg_console_whole(text + 9, UINT32_MAX, &count)) {
        return false;
    }
    *number = (uint64_t)boot << 32U | count;
    return true;
}

/** A command to enable. */
typedef struct enabling {
    bool leased;
    bool unattended; /**< without a lease, by a word that says so */
    bool after;      /**< only if the newest stop has `number` */
    uint64_t number;
} enabling_t;

/** Reads "enable [leased|unattended] [after=<number>]".  Returns false if it has another form. */
static bool read_enabling(const epg_console_command_t *command, enabling_t *enabling)
{
    static const char after[] = "after=";
    size_t next = 1;
    *enabling = (enabling_t){0};
    if (next < command->count) {
        enabling->leased = strcmp(command->words[next], "leased") == 0;
        enabling->unattended = strcmp(command->words[next], "unattended") == 0;
        next += enabling->leased || enabling->unattended ? 1U : 0U;
    }
    if (next < command->count && strncmp(command->words[next], after, sizeof after - 1) == 0) {
        enabling->after = read_stop_number(command->words[next] + sizeof after - 1, &enabling->number);
        next += enabling->after ? 1U : 0U;
    }
    return next == command->count;
}

/** Returns the mistake in a command to enable; NULL: there is none. */
static const char *find_mistake(const epg_console_session_t *session, const enabling_t *enabling)
{
    const bool framed = session->output.framed;
    if (framed && !enabling->leased && !enabling->unattended) {
        return "a program must say 'leased' or 'unattended'";
    }
    if (framed && !enabling->after) {
        return "a program must name the newest stop that it knows: after=<number>";
    }
    if (enabling->leased && !framed) {
        return "a lease is for programs that use frames";
    }
    if (enabling->leased && session->has_status && session->status.enabled && !session->status.leased) {
        return "the target is enabled already, without a lease";
    }
    return NULL;
}

void epg_console_enable(epg_console_session_t *session, const epg_console_command_t *command)
{
    enabling_t enabling;
    if (!read_enabling(command, &enabling)) {
        epg_console_error(session, "enable", "use enable [leased|unattended] [after=<number>]", NULL);
        return;
    }
    const char *mistake = find_mistake(session, &enabling);
    if (mistake != NULL) {
        epg_console_error(session, "enable", mistake, NULL);
        return;
    }
    if (enabling.after && session->has_status && session->status.stop_number != enabling.number) {
        epg_console_wait_for(session, "enable", EPG_CONSOLE_REFUSING);
        return;
    }
    if (!epg_console_may_move(session, "enable")) {
        return;
    }
    unsigned int request = enabling.after ? epg_enable_after(enabling.number) : (unsigned int)EPG_ENABLE_ANY;
    if (enabling.leased) {
        epg_console_begin_lease(session);
        request |= EPG_ENABLE_LEASED;
    }
    epg_gate_enable(session->target->control, EPG_GATE_CONSOLE, request);
    epg_console_wait_for(session, "enable", EPG_CONSOLE_ENABLING);
}

void epg_console_disable(epg_console_session_t *session, const epg_console_command_t *command)
{
    /* Disabling must act even if the line has more words. */
    (void)command;
    if (!session->input.stopped) {
        epg_stop(session->target->control, session->output.framed ? EPG_STOP_FRAME : EPG_STOP_LINE);
    }
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

/** Reports a number that is outside of the limits of its setpoint. */
static void refuse_setpoint(epg_console_session_t *session, const char *name, const epg_setpoint_t *setpoint)
{
    epg_console_output_t *output = &session->output;
    epg_console_begin(output, "error setpoint ");
    epg_console_text(output, name);
    epg_console_text(output, " must be from ");
    epg_console_double(output, setpoint->minimum);
    epg_console_text(output, " to ");
    epg_console_double(output, setpoint->maximum);
    if (setpoint->unit != NULL) {
        epg_console_text(output, " ");
        epg_console_text(output, setpoint->unit);
    }
    epg_console_end_or_drop(output);
}

void epg_console_setpoints(epg_console_session_t *session, const epg_console_command_t *command)
{
    const epg_setpoint_t *setpoints = session->target->application->setpoints;
    size_t indices[EPG_CONSOLE_WORDS];
    double values[EPG_CONSOLE_WORDS];
    if (!epg_console_may_move(session, "setpoint")) {
        return;
    }
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
        if (!epg_setpoint_accepts(&setpoints[indices[i]], values[i])) {
            refuse_setpoint(session, command->words[i], &setpoints[indices[i]]);
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

/** A movement by hand. */
typedef struct movement {
    size_t actuator;
    double duty;
    uint32_t time_ms;
    bool leased;     /**< it ends with the lease that `number` extends */
    uint32_t number; /**< of those that the target has sent; 0: none, the command asks for one */
} movement_t;

/** Reads the last word of "jog <actuator> <duty> <ms> [number=<n>]".  Returns false after a message. */
static bool read_number(epg_console_session_t *session, const epg_console_command_t *command, movement_t *movement)
{
    static const char number[] = "number=";
    const char *last = command->words[command->count - 1U];
    movement->leased = command->count == 5 && strncmp(last, number, sizeof number - 1) == 0 &&
                       epg_console_whole(last + sizeof number - 1, UINT32_MAX, &movement->number);
    if (!movement->leased && command->count != 4) {
        epg_console_error(session, "jog", "use jog <actuator> <duty> <ms>", NULL);
        return false;
    }
    if (movement->leased && !session->output.framed) {
        epg_console_error(session, "jog", "a number is for programs that use frames", NULL);
        return false;
    }
    return true;
}

/** Reads the other words of the command.  Returns false after a message. */
static bool read_movement(epg_console_session_t *session, const epg_console_command_t *command, movement_t *movement)
{
    const epg_console_options_t *options = session->options;
    movement->actuator = find_actuator(session->target->application->jog, command->words[1]);
    if (movement->actuator == SIZE_MAX) {
        epg_console_error(session, "jog", "there is no actuator", command->words[1]);
    } else if (!epg_console_number(command->words[2], &movement->duty)) {
        epg_console_error(session, "jog", "this is not a number:", command->words[2]);
    } else if (movement->duty > options->jog_duty || movement->duty < -options->jog_duty) {
        epg_console_begin(&session->output, "error jog the duty must be at most ");
        epg_console_double(&session->output, options->jog_duty);
        epg_console_text(&session->output, " for this target");
        epg_console_end_or_drop(&session->output);
    } else if (!epg_console_whole(command->words[3], (uint32_t)(options->jog_time_ns / 1000000U), &movement->time_ms) ||
               movement->time_ms == 0) {
        epg_console_begin(&session->output, "error jog the time must be from 1 to ");
        epg_console_integer(&session->output, (int64_t)(options->jog_time_ns / 1000000U));
        epg_console_text(&session->output, " ms for this target");
        epg_console_end_or_drop(&session->output);
    } else {
        return true;
    }
    return false;
}

/** Returns the end of a movement with a number, in ns of board time; 0: the number does not count (any more). */
static uint64_t end_of_movement(epg_console_session_t *session, const movement_t *movement)
{
    const uint64_t latest_ns = epg_console_may_move_until(session, movement->number);
    const uint64_t until_ns = session->now_ns + (uint64_t)movement->time_ms * 1000000U;
    return until_ns < latest_ns ? until_ns : latest_ns;
}

/** Begins a movement; `until_ns`: the end of one with a number. */
static void begin_movement(epg_console_session_t *session, const movement_t *movement, uint64_t until_ns)
{
    const epg_application_t *application = session->target->application;
    uint32_t cycles = EPG_JOG_LEASED;
    if (movement->leased) {
        epg_control_extend(session->target->control, until_ns);
    } else {
        const uint64_t period_ns = application->period_ns;
        const uint64_t whole = ((uint64_t)movement->time_ms * 1000000U + period_ns / 2U) / period_ns;
        cycles = whole == 0 ? 1U : (uint32_t)whole;
    }
    session->live.jog_tag = session->output.tag;
    session->jogging = epg_jog_start(application->jog, movement->actuator, movement->duty, cycles);
    if (!session->jogging) {
        epg_console_error(session, "jog", "an actuator is moving", NULL);
    }
}

/** Answers a movement whose number does not count. */
static void refuse_number(epg_console_session_t *session, uint32_t number)
{
    if (number == 0U) {
        epg_console_done(session, "jog");
    } else {
        epg_console_error(session, "jog", "the number is too old", NULL);
    }
}

/** Answers a movement while another one is in progress, or prolongs it if it is the same. */
static void go_on_moving(epg_console_session_t *session, const movement_t *movement, uint64_t until_ns)
{
    epg_jog_t *jog = session->target->application->jog;
    if (movement->leased && epg_jog_is_leased(jog, movement->actuator, movement->duty)) {
        epg_control_extend(session->target->control, until_ns);
        epg_console_done(session, "jog");
    } else {
        epg_console_error(session, "jog", "an actuator is moving", NULL);
    }
}

void epg_console_jog(epg_console_session_t *session, const epg_console_command_t *command)
{
    movement_t movement = {0};
    if (session->target->application->jog == NULL || session->options->jog_duty <= 0.0) {
        epg_console_error(session, "jog", "this target has no jog", NULL);
        return;
    }
    if (!read_number(session, command, &movement) || !read_movement(session, command, &movement)) {
        return;
    }
    if (session->has_status && session->status.enabled) {
        epg_console_error(session, "jog", "the target is enabled: disable it", NULL);
        return;
    }
    const uint64_t until_ns = movement.leased ? end_of_movement(session, &movement) : 0U;
    if (movement.leased && until_ns == 0U) {
        refuse_number(session, movement.number);
    } else if (session->jogging) {
        go_on_moving(session, &movement, until_ns);
    } else if (!epg_gate_move(session->target->control)) {
        epg_console_wait_for(session, "jog", EPG_CONSOLE_REFUSING);
    } else if (epg_console_may_move(session, "jog")) {
        begin_movement(session, &movement, until_ns);
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
