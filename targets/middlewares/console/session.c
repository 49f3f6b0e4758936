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
