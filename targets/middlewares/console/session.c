/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The answers of commands.
 */
#include "session.h"

#include "epg/names.h"
#include "epg/store.h"

void epg_console_ok(epg_console_session_t *self, const char *command)
{
    epg_console_begin(&self->output, "ok ");
    epg_console_text(&self->output, command);
}

void epg_console_done(epg_console_session_t *self, const char *command)
{
    epg_console_ok(self, command);
    epg_console_end_or_drop(&self->output);
}

void epg_console_error(epg_console_session_t *self, const char *command, const char *message, const char *about)
{
    epg_console_begin(&self->output, "error ");
    epg_console_text(&self->output, command);
    epg_console_text(&self->output, " ");
    epg_console_text(&self->output, message);
    if (about != NULL) {
        epg_console_text(&self->output, " '");
        epg_console_text(&self->output, about);
        epg_console_text(&self->output, "'");
    }
    epg_console_end_or_drop(&self->output);
}

void epg_console_answer(epg_console_session_t *self, const char *command, epg_console_list_t *list)
{
    self->list = list;
    self->live.list_tag = self->output.tag;
    self->list_command = command;
    self->list_index = 0;
}

void epg_console_wait_for(epg_console_session_t *self, const char *command, epg_console_wait_t wait)
{
    self->wait = wait;
    self->live.wait_tag = self->output.tag;
    self->wait_command = command;
    self->wait_since_ns = self->now_ns;
    self->wait_cycles = self->has_status ? self->status.statistics.cycles : 0U;
}

void epg_console_fault(epg_console_session_t *self, const epg_status_t *status)
{
    const char *name = epg_target_fault(self->target, status->fault);
    epg_console_text(&self->output, " fault=");
    for (size_t i = 0; name[i] != '\0'; i++) {
        epg_console_text(&self->output, name[i] == ' ' ? "_" : (char[]){name[i], '\0'});
    }
    const char *component = epg_target_component(self->target, status->fault_component);
    if (status->fault != EPG_FAULT_NONE && component[0] != '\0') {
        epg_console_word(&self->output, "component", component);
    }
    const char *setpoint = epg_target_stalling_setpoint(self->target, status);
    if (setpoint[0] != '\0') {
        epg_console_word(&self->output, "setpoint", setpoint);
    }
}

/** Appends the number of the newest stop for a program, which must name it to enable the target. */
static void put_stop_number(epg_console_session_t *self, const epg_status_t *status)
{
    if (!self->output.framed) {
        return;
    }
    epg_console_key(&self->output, "stop");
    for (unsigned int shift = 64; shift > 32; shift -= 4) {
        const char digit = "0123456789abcdef"[status->stop_number >> (shift - 4) & 15U];
        epg_console_bytes(&self->output, &digit, 1);
    }
    epg_console_text(&self->output, "-");
    epg_console_integer(&self->output, (int64_t)(status->stop_number & UINT32_MAX));
}

void epg_console_stop(epg_console_session_t *self, const epg_status_t *status)
{
    put_stop_number(self, status);
    if (self->output.framed || !status->enabled) {
        epg_console_word(&self->output, "by", epg_stop_source_name(status->stop_source));
    }
}

void epg_console_refused(epg_console_session_t *self)
{
    epg_console_text(&self->output, "refused: stopped by ");
    epg_console_text(&self->output, epg_stop_source_name(self->status.stop_source));
    if (self->status.fault != EPG_FAULT_NONE) {
        epg_console_fault(self, &self->status);
    }
    put_stop_number(self, &self->status);
}

bool epg_console_is_overtaken(const epg_console_session_t *self)
{
    const epg_stream_t *stream = self->stream;
    return stream->overtaken != NULL && stream->overtaken(stream->context);
}

bool epg_console_may_move(epg_console_session_t *self, const char *command)
{
    const bool may = self->input.may_move && !epg_console_is_overtaken(self);
    if (!may) {
        epg_console_wait_for(self, command, EPG_CONSOLE_REFUSING);
    }
    return may;
}

uint64_t epg_console_since_start(const epg_console_session_t *self, uint64_t time_ns)
{
    return time_ns > self->start_ns ? time_ns - self->start_ns : 0U;
}

void epg_console_node(epg_console_session_t *self)
{
    char name[EPG_STORE_NAME_SIZE];
    (void)epg_names_expand(epg_names_node(self->target), name, sizeof name);
    epg_console_word(&self->output, "node", name);
}
