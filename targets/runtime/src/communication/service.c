/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services of a node: the work on one request, and replies that are written in pieces.
 */
#include "epg/service.h"

#include <string.h>

#include "reply.h"

/** A control loop without a cycle for this time does not run. */
static const uint64_t NO_CYCLE_NS = 500000000;

static epg_service_state_t *state_of(const epg_node_t *node)
{
    return node->target->service_state;
}

size_t epg_service_topic(const epg_node_t *node, size_t service, bool reply, char *name, size_t size)
{
    const char *end = reply ? "Reply" : "Request";
    const size_t end_size = strlen(end) + 1;
    if (size < 2) {
        return 0;
    }
    const size_t length = epg_node_name(node, node->target->services[service].name, true, name + 2, size - 2);
    if (length == 0 || end_size > size - 2 - length) {
        return 0;
    }
    name[0] = 'r';
    name[1] = reply ? 'r' : 'q';
    memcpy(name + 2 + length, end, end_size);
    return 2 + length + end_size - 1;
}

bool epg_service_idle(const epg_node_t *node)
{
    return state_of(node)->service == NULL;
}

bool epg_service_is_stop(const epg_node_t *node, size_t service, const void *request, size_t size)
{
    const unsigned char *data = request;
    return node->target->services[service].kind == &epg_service_enable && size > 0 && data[0] == 0;
}

epg_service_result_t epg_service_request(epg_node_t *node, size_t service, const void *request, size_t size,
                                         uint64_t now_ns)
{
    epg_service_state_t *state = state_of(node);
    const epg_service_t *asked = &node->target->services[service];
    if (state->service != NULL) {
        return EPG_SERVICE_BUSY;
    }
    if (size > asked->request_size || size > state->request_size) {
        node->malformed++;
        return EPG_SERVICE_MALFORMED;
    }
    if (size > 0) {
        memmove(state->request, request, size);
    }
    state->length = size;
    state->taken_ns = now_ns;
    state->ready = false;
    epg_cdr_reader_t reader = {.data = state->request, .size = size};
    const bool taken = asked->kind->take(node, &reader);
    state->stopped = false;
    state->overtaken = false;
    if (!taken) {
        node->malformed++;
        return EPG_SERVICE_MALFORMED;
    }
    state->service = asked;
    return EPG_SERVICE_TAKEN;
}

/** Writes the bytes `offset` ... `offset` + `size` - 1 of the reply, as far as it has them.  Returns their number. */
static size_t write_window(epg_node_t *node, size_t offset, unsigned char *to, size_t size)
{
    epg_service_state_t *state = state_of(node);
    if (offset < state->position) {
        state->part = 0;
        state->position = 0;
    }
    epg_reply_t reply = {.window = to, .begin = offset, .end = offset + size, .position = state->position};
    for (size_t part = state->part; reply.position < reply.end; part++) {
        if (!state->service->kind->write(node, &reply, part)) {
            break;
        }
        if (reply.position <= reply.end) { /* the next window begins in a later part */
            state->part = part + 1;
            state->position = reply.position;
        }
    }
    const size_t end = reply.position < reply.end ? reply.position : reply.end;
    return end > offset ? end - offset : 0;
}

/** Returns the size of the reply, which is ready. */
static size_t measure(epg_node_t *node)
{
    const epg_service_kind_t *kind = state_of(node)->service->kind;
    epg_reply_t reply = {0};
    for (size_t part = 0; kind->write(node, &reply, part); part++) {
    }
    return reply.position;
}

bool epg_service_poll(epg_node_t *node, uint64_t now_ns)
{
    epg_service_state_t *state = state_of(node);
    if (state->service == NULL || state->ready) {
        return state->service != NULL;
    }
    const bool late = now_ns - state->taken_ns > NO_CYCLE_NS;
    if (state->service->kind->ready != NULL && !state->service->kind->ready(node, late)) {
        return false;
    }
    state->ready = true;
    state->part = 0;
    state->position = 0;
    state->reply_size = measure(node);
    return true;
}

size_t epg_service_reply_size(const epg_node_t *node)
{
    return state_of(node)->reply_size;
}

size_t epg_service_reply(epg_node_t *node, size_t offset, void *to, size_t size)
{
    const size_t left = offset < state_of(node)->reply_size ? state_of(node)->reply_size - offset : 0;
    return write_window(node, offset, to, size < left ? size : left);
}

void epg_service_done(epg_node_t *node)
{
    state_of(node)->service = NULL;
}
