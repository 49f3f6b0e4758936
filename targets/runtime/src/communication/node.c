/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A ROS 2 node without its transport: which publications are due, and messages to values and back.
 */
#include "epg/node.h"

#include <string.h>

#include "epg/diagnostics.h"
#include "epg/names.h"
#include "epg/port.h"

#define SECOND_NS 1000000000
/** Writing the diagnostics takes as long as all values together.  They wait this long for a call without values. */
#define DIAGNOSTICS_WAIT_NS UINT64_C(5000000)
/** A message of an unnamed sender that arrives so soon after a connection may have waited in an agent. */
#define STALE_NS SECOND_NS
/** A `true` that follows another one within this time may come from a node that repeats it. */
#define REPEATED_NS SECOND_NS
/** Longest time for which topics with a stamp wait until the clock is set. */
#define CLOCK_WAIT_NS SECOND_NS

/** Remembers that `values` are those of a cycle, and its time. */
static void accept_values(epg_node_t *node)
{
    node->valid = true;
    memcpy(&node->time_ns, &node->values[node->target->time_index], sizeof node->time_ns);
}

/** Copies the monitoring values of the newest cycle.  They stay the same until the next call. */
static void take_values(epg_node_t *node)
{
    if (epg_control_monitor(node->target->control, node->values)) {
        accept_values(node);
    }
}

/** The cycles that wait for publications with EPG_TOPIC_CYCLES; NULL if these publish the newest cycle, too. */
static epg_history_t *history_of(const epg_node_t *node)
{
    return node->target->application->history;
}

static epg_stamp_t stamp_at(uint64_t time_ns)
{
    return (epg_stamp_t){.seconds = (int32_t)(time_ns / SECOND_NS), .nanoseconds = (uint32_t)(time_ns % SECOND_NS)};
}

static epg_stamp_t stamp_of(const epg_node_t *node)
{
    return stamp_at(epg_clock_stamp_ns(&node->clock, node->time_ns));
}

/**
 * Returns the first instant after `time_ns` of a schedule that has an instant at `due_ns` and the period `period_ns`.
 */
static uint64_t next_after(uint64_t due_ns, uint64_t period_ns, uint64_t time_ns)
{
    return due_ns + ((time_ns - due_ns) / period_ns + 1) * period_ns;
}

static bool changed(const epg_node_t *node, const epg_topic_t *topic, const epg_node_publication_t *state)
{
    const size_t size = topic->count * sizeof(double);
    return !state->sent || memcmp(&node->values[topic->index], &node->sent_values[topic->index], size) != 0;
}

/** Returns true if publication `topic` is due with the present values, and advances its schedule then. */
static bool is_due(epg_node_t *node, const epg_topic_t *topic, epg_node_publication_t *state, uint64_t now_ns)
{
    if (topic->role == EPG_TOPIC_ECHO || (topic->role == EPG_TOPIC_VALUES && !node->valid)) {
        return false;
    }
    if (node->waits && topic->message->stamped) {
        state->due_ns = topic->trigger == EPG_TOPIC_PERIOD ? now_ns : state->due_ns;
        return false;
    }
    if (topic->trigger == EPG_TOPIC_CHANGE) {
        return changed(node, topic, state);
    }
    const bool cycles = topic->trigger == EPG_TOPIC_CYCLES;
    const uint64_t time_ns = cycles ? node->time_ns : now_ns;
    const uint64_t period_ns = cycles ? topic->cycles * node->target->application->period_ns : topic->period_ns;
    if (time_ns < state->due_ns) {
        return false;
    }
    state->due_ns = next_after(state->due_ns, period_ns, time_ns);
    return true;
}

static size_t write_message(epg_node_t *node, const epg_topic_t *topic, uint64_t now_ns)
{
    if (topic->role == EPG_TOPIC_CLOCK) {
        return topic->message->write(topic, NULL, stamp_at(now_ns), node->buffer, node->buffer_size);
    }
    if (topic->role == EPG_TOPIC_DIAGNOSTICS) {
        return epg_diagnostics_write(node, stamp_of(node), node->buffer, node->buffer_size);
    }
    return topic->message->write(topic, &node->values[topic->index], stamp_of(node), node->buffer, node->buffer_size);
}

/** Sends publication `index`; if the middleware has no room, the publication waits for the next call. */
static void publish(epg_node_t *node, size_t index, uint64_t now_ns)
{
    const epg_topic_t *topic = &node->target->publications[index];
    epg_node_publication_t *state = &node->publications[index];
    const size_t size = write_message(node, topic, now_ns);
    if (size == 0) {
        state->waiting = false; /* there are no data yet */
        return;
    }
    if (!state->waiting) {
        epg_target_publishing(node->target, index);
    }
    state->waiting = !node->send(index, node->buffer, size);
    if (!state->waiting && topic->trigger == EPG_TOPIC_CHANGE) {
        memcpy(&node->sent_values[topic->index], &node->values[topic->index], topic->count * sizeof(double));
        state->sent = true;
    }
}

void epg_node_start(epg_node_t *node, const epg_target_t *target,
                    bool (*send)(size_t publication, const void *data, size_t size))
{
    node->target = target;
    node->send = send;
    node->valid = false;
    node->time_ns = 0;
    epg_clock_start(&node->clock, target->simulated_time);
    node->unsent = 0;
    node->lost_seen = 0;
    node->malformed = 0;
    node->client_advice = NULL;
    node->edge = (epg_node_edge_t){0};
    for (size_t i = 0; i < EPG_NODE_WARNINGS; i++) {
        node->warnings[i] = (epg_node_warning_t){0};
    }
    (void)epg_names_expand(epg_names_node(target), node->name, sizeof node->name);
    (void)epg_names_expand(epg_names_space(target), node->name_space, sizeof node->name_space);
    for (size_t i = 0; i < target->publication_count; i++) {
        node->publications[i] = (epg_node_publication_t){0};
    }
}

void epg_node_delayed(epg_node_t *node, uint64_t now_ns)
{
    node->connected_ns = now_ns;
    node->edge.low = false;
}

void epg_node_connected(epg_node_t *node, uint64_t now_ns)
{
    if (history_of(node) != NULL) {
        epg_history_drop_all(history_of(node));
        node->lost_seen = (uint32_t)atomic_load(&history_of(node)->lost);
    }
    epg_node_delayed(node, now_ns);
    node->waits = !node->clock.set;
    take_values(node);
    for (size_t i = 0; i < node->target->publication_count; i++) {
        const bool cycles = node->target->publications[i].trigger == EPG_TOPIC_CYCLES;
        node->publications[i] = (epg_node_publication_t){.due_ns = cycles ? node->time_ns : now_ns};
    }
}

/** Sends publication `index` if it is due with the present values, or waits for room.  Returns true if it was. */
static bool publish_if_due(epg_node_t *node, size_t index, uint64_t now_ns)
{
    epg_node_publication_t *state = &node->publications[index];
    const bool due = is_due(node, &node->target->publications[index], state, now_ns);
    node->unsent += due && state->waiting ? 1U : 0U;
    const bool published = due || state->waiting;
    if (published) {
        publish(node, index, now_ns);
    }
    return published;
}

/** Returns true if publication `index` can wait for a call with less work. */
static bool can_wait(const epg_node_t *node, size_t index, uint64_t now_ns)
{
    const epg_node_publication_t *state = &node->publications[index];
    return node->target->publications[index].role == EPG_TOPIC_DIAGNOSTICS && !state->waiting &&
           now_ns < state->due_ns + DIAGNOSTICS_WAIT_NS;
}

/**
 * Sends the publications of the oldest cycle in the history.  Returns false if one of them found no room: that cycle
 * stays in the history.
 */
static bool publish_cycle(epg_node_t *node, uint64_t now_ns)
{
    bool done = true;
    for (size_t i = 0; i < node->target->publication_count; i++) {
        if (node->target->publications[i].trigger == EPG_TOPIC_CYCLES) {
            (void)publish_if_due(node, i, now_ns);
            done = done && !node->publications[i].waiting;
        }
    }
    return done;
}

/**
 * Sends the publications of all cycles in the history, the oldest first, until there is no more room.  Returns true if
 * there was a cycle.
 */
static bool publish_history(epg_node_t *node, epg_history_t *history, uint64_t now_ns)
{
    bool found = false;
    /* Cycles that end meanwhile wait for the next call, so that this one ends. */
    for (uint32_t left = history->depth; left > 0U && epg_history_peek(history, node->values); left--) {
        found = true;
        accept_values(node);
        if (!publish_cycle(node, now_ns)) {
            break;
        }
        epg_history_drop(history);
    }
    const uint32_t lost = (uint32_t)atomic_load(&history->lost);
    node->unsent += lost - node->lost_seen;
    node->lost_seen = lost;
    return found;
}

bool epg_node_poll(epg_node_t *node, uint64_t now_ns)
{
    epg_history_t *history = history_of(node);
    node->waits = node->waits && now_ns < node->connected_ns + CLOCK_WAIT_NS;
    bool busy = history != NULL && publish_history(node, history, now_ns);
    /* All publications that are due now get values of the same cycle. */
    take_values(node);
    for (size_t i = 0; i < node->target->publication_count; i++) {
        const bool by_history = history != NULL && node->target->publications[i].trigger == EPG_TOPIC_CYCLES;
        if (!by_history && !(busy && can_wait(node, i, now_ns))) {
            busy = publish_if_due(node, i, now_ns) || busy;
        }
    }
    /* Only now, so that the call after an answer that has set the clock does not send all that has waited, too. */
    node->waits = node->waits && !node->clock.set;
    return busy;
}

static void receive_values(epg_node_t *node, const epg_topic_t *topic, uint64_t now_ns)
{
    const epg_setpoint_t *setpoints = node->target->application->setpoints;
    size_t refused = topic->count;
    for (size_t i = 0; i < topic->count; i++) {
        if (!epg_setpoint_accepts(&setpoints[topic->index + i], node->received[i])) {
            refused = i;
        }
    }
    if (refused < topic->count) { /* one refused value drops the whole message, which counts once */
        (void)epg_control_receive(node->target->control, topic->index + refused, node->received[refused], now_ns,
                                  false);
        return;
    }
    for (size_t i = 0; i < topic->count; i++) {
        (void)epg_control_receive(node->target->control, topic->index + i, node->received[i], now_ns,
                                  i + 1 == topic->count);
    }
}

void epg_node_listen(epg_node_t *node)
{
    node->services_clean = epg_gate_poll(node->target->control, EPG_GATE_SERVICE);
    node->topics_clean = epg_gate_poll(node->target->control, EPG_GATE_TOPIC);
}

/** Returns the place of a publisher among those whose own last message was `true`; EPG_NODE_PUBLISHERS: it is not there. */
static size_t place_of(const epg_node_edge_t *edge, uint32_t publisher)
{
    size_t place = 0;
    while (place < EPG_NODE_PUBLISHERS && (publisher == 0 || edge->high[place] != publisher)) {
        place++;
    }
    return place;
}

/** Remembers that the newest message of a publisher is `true`.  Of too many, the one that was silent longest is forgotten. */
static void add_high(epg_node_edge_t *edge, uint32_t publisher)
{
    size_t place = place_of(edge, publisher);
    for (place = place < EPG_NODE_PUBLISHERS ? place : EPG_NODE_PUBLISHERS - 1U; place > 0; place--) {
        edge->high[place] = edge->high[place - 1U];
    }
    edge->high[0] = publisher;
}

static void remove_high(epg_node_edge_t *edge, uint32_t publisher)
{
    const size_t place = place_of(edge, publisher);
    if (place < EPG_NODE_PUBLISHERS) {
        edge->high[place] = 0;
    }
}

static void receive_false(epg_node_t *node, uint32_t publisher, uint64_t now_ns)
{
    epg_control_t *control = node->target->control;
    epg_stop(control, EPG_STOP_TOPIC);
    node->edge.low = true;
    node->edge.early = publisher == 0 && now_ns - node->connected_ns < STALE_NS;
    remove_high(&node->edge, publisher);
    epg_gate_open(control, EPG_GATE_EDGE);
    /* In this order: another stop since this message arrived has closed the one gate or closes the other. */
    if (!node->topics_clean || !epg_gate_is_open(control, EPG_GATE_TOPIC)) {
        epg_gate_close(control, EPG_GATE_EDGE);
    }
}

/** Returns the reason why a `true` does not enable, and the remedy; NULL: it enables. */
static const char *find_advice(const epg_node_t *node, uint32_t publisher, bool low, bool repeated)
{
    const epg_node_edge_t *edge = &node->edge;
    if (!low) {
        return "the message before it was not false: send false, then true";
    }
    if (edge->early) {
        return "the false came within a second after the connection: send false, then true";
    }
    if (place_of(edge, publisher) < EPG_NODE_PUBLISHERS) {
        return "its own node sent a true before: let it send false, then true";
    }
    if (repeated) {
        return "it followed a true within a second: do not repeat true, send false, then true";
    }
    if (!node->topics_clean || !epg_gate_is_open(node->target->control, EPG_GATE_EDGE)) {
        return "another stop came after the false: send false, then true";
    }
    return NULL;
}

static void receive_true(epg_node_t *node, uint32_t publisher, uint64_t now_ns)
{
    epg_control_t *control = node->target->control;
    epg_node_edge_t *edge = &node->edge;
    const bool low = edge->low;
    const bool repeated = edge->risen && now_ns - edge->risen_ns < REPEATED_NS;
    edge->low = false;
    edge->risen = true;
    edge->risen_ns = now_ns;
    const char *advice = find_advice(node, publisher, low, repeated);
    add_high(edge, publisher);
    epg_status_t status;
    if (advice == NULL) {
        epg_gate_enable(control, EPG_GATE_EDGE, EPG_ENABLE_ANY);
    } else if (!epg_control_observe(control, &status) || !status.enabled) {
        edge->ignored++;
    } else {
        return; /* the target is enabled: nothing was asked for */
    }
    edge->advice = advice;
}

void epg_node_receive(epg_node_t *node, size_t subscription, const void *data, size_t size, uint32_t publisher,
                      uint64_t now_ns)
{
    if (subscription >= node->target->subscription_count) {
        return;
    }
    const epg_topic_t *topic = &node->target->subscriptions[subscription];
    if (topic->role == EPG_TOPIC_ECHO) {
        node->unsent += node->send(topic->index, data, size) ? 0U : 1U;
        return;
    }
    if (!topic->message->read(topic, data, size, node->received)) {
        node->malformed++;
    } else if (topic->role == EPG_TOPIC_ENABLE) {
        if (node->received[0] > 0.5) {
            receive_true(node, publisher, now_ns);
        } else {
            receive_false(node, publisher, now_ns);
        }
    } else {
        receive_values(node, topic, now_ns);
    }
}

size_t epg_node_name(const epg_node_t *node, const char *relative, bool service, char *name, size_t size)
{
    const char *rest = relative;
    const char *parts[4] = {"", "", "", ""};
    if (rest[0] == '~') {
        parts[0] = node->name_space;
        parts[1] = "/";
        parts[2] = node->name;
        rest++;
    } else if (rest[0] != '/') {
        parts[0] = node->name_space;
        parts[1] = "/";
    }
    parts[3] = rest;
    size_t length = 0;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const size_t count = strlen(parts[i]);
        if (count >= size - length) {
            return 0;
        }
        memcpy(name + length, parts[i], count + 1);
        length += count;
    }
    if (node->target->rename == NULL || strcmp(relative, "~") == 0) {
        return length;
    }
    const char *renamed = node->target->rename(name, service);
    length = strlen(renamed);
    if (length >= size) {
        return 0;
    }
    memmove(name, renamed, length + 1);
    return length;
}

size_t epg_node_topic(const epg_node_t *node, const epg_topic_t *topic, char *name, size_t size)
{
    return epg_node_name(node, topic->name, false, name, size);
}

uint32_t epg_node_key(const epg_node_t *node)
{
    const char *const parts[] = {node->program != NULL ? node->program : "", epg_port_serial(), node->name_space,
                                 node->name};
    uint32_t hash = 2166136261U;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        for (const char *text = parts[i]; *text != '\0'; text++) {
            hash = (hash ^ (uint8_t)*text) * 16777619U;
        }
        hash = (hash ^ '/') * 16777619U;
    }
    return hash == 0 ? 1 : hash;
}
