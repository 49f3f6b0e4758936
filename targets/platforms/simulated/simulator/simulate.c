/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The simulation of a system: one thread, which takes the events in the order of their times.
 */
#include "simulate.h"

#include <stdlib.h>
#include <string.h>

#include "files/number.h"
#include "random.h"

static const epg_target_t *target_of(const member_t *member)
{
    return member->unit->host->target;
}

static bool short_of_memory(void)
{
    fputs("error: not enough memory for the events of the system\n", stderr);
    return false;
}

static bool wait_for(simulation_t *simulation, const event_t *event)
{
    return queue_add(&simulation->queue, event) || short_of_memory();
}

static bool add(simulation_t *simulation, event_kind_t kind, uint64_t time_ns, size_t place, uint64_t number)
{
    const bool of_life = kind == EVENT_CYCLE || kind == EVENT_PUBLICATION;
    const event_t event = {.time_ns = time_ns,
                           .kind = kind,
                           .place = place,
                           .life = of_life ? simulation->members[place].life : 0U,
                           .number = number};
    return time_ns >= simulation->end_ns || wait_for(simulation, &event);
}

/** Adds the first events of the present life of a target. */
static bool begin(simulation_t *simulation, size_t index)
{
    const member_t *member = &simulation->members[index];
    const bool publishes = target_of(member)->publication_count > 0 && target_of(member)->communication_period_ns > 0;
    return add(simulation, EVENT_CYCLE, member->started_ns, index, 0) &&
           (!publishes || add(simulation, EVENT_PUBLICATION, member->started_ns, index, 0));
}

/* Messages --------------------------------------------------------------------------------------------------------- */

/** The arrival of the next message of a connection, which is sent now; UINT64_MAX: it is lost. */
static uint64_t arrival_of(simulation_t *simulation, size_t index, uint64_t time_ns)
{
    const epg_system_connection_t *facts = &simulation->system->connections[index];
    way_t *way = &simulation->ways[index];
    random_t random = random_of(simulation->seed, facts->name, way->sent++);
    uint64_t arrival_ns = time_ns + facts->delay_ns + random_below(&random, facts->jitter_ns + 1U);
    while (random_below(&random, 1000000U) < facts->loss_ppm) {
        if (!facts->reliable) {
            return UINT64_MAX;
        }
        arrival_ns += 2U * (facts->delay_ns + facts->jitter_ns); /* the receiver asks for it, and it comes again */
    }
    if (facts->reliable && arrival_ns < way->newest_ns) {
        arrival_ns = way->newest_ns; /* it does not overtake */
    }
    way->newest_ns = arrival_ns;
    return arrival_ns;
}

/** Puts a message with the monitored values on its way. */
static bool send(simulation_t *simulation, size_t index, uint64_t time_ns)
{
    const epg_system_connection_t *facts = &simulation->system->connections[index];
    const member_t *sender = &simulation->members[facts->sender];
    const epg_topic_t *topic = &target_of(sender)->publications[facts->publication];
    event_t event = {.time_ns = arrival_of(simulation, index, time_ns),
                     .kind = EVENT_ARRIVAL,
                     .place = index,
                     .number = simulation->ways[index].sent};
    if (sender->offline || event.time_ns >= simulation->end_ns) {
        return true;
    }
    event.message = malloc(topic->size);
    if (event.message == NULL) {
        return short_of_memory();
    }
    const uint64_t clock_ns = member_clock_ns(sender, time_ns);
    const epg_stamp_t stamp = {.seconds = (int32_t)(clock_ns / 1000000000U),
                               .nanoseconds = (uint32_t)(clock_ns % 1000000000U)};
    event.size = topic->message->write(topic, &sender->monitored[topic->index], stamp, event.message, topic->size);
    return wait_for(simulation, &event);
}

static void arrive(simulation_t *simulation, const event_t *event)
{
    const epg_system_connection_t *facts = &simulation->system->connections[event->place];
    way_t *way = &simulation->ways[event->place];
    member_t *receiver = &simulation->members[facts->receiver];
    const epg_topic_t *topic = &target_of(receiver)->subscriptions[facts->subscription];
    if (event->number <= way->received) {
        return; /* DDS drops a message that is older than the newest one */
    }
    way->received = event->number;
    if (receiver->offline || receiver->state != MEMBER_RUNS) {
        return;
    }
    if (!topic->message->read(topic, event->message, event->size, receiver->received)) {
        return;
    }
    const uint64_t clock_ns = member_clock_ns(receiver, event->time_ns);
    for (size_t i = 0; i < topic->count; i++) {
        receiver->unit->receive(topic->index + i, receiver->received[i], clock_ns, i + 1U == topic->count);
    }
}

/** Sends publication `index` of a target, whose values are in `monitored`. */
static bool publish(simulation_t *simulation, size_t index, size_t publication, uint64_t time_ns)
{
    const member_t *member = &simulation->members[index];
    const epg_topic_t *topic = &target_of(member)->publications[publication];
    for (size_t i = 0; simulation->topics != NULL && i < topic->count; i++) {
        epg_host_write_number(simulation->topics, epg_host_seconds(time_ns));
        const char *name = epg_topic_value_name(topic, i);
        const bool absolute = name[0] == '/';
        fprintf(simulation->topics, ",%s%s%s,", absolute ? "" : member->facts->name, absolute ? "" : "/", name);
        epg_host_write_number(simulation->topics, member->monitored[topic->index + i]);
        fputc('\n', simulation->topics);
    }
    for (size_t i = 0; i < simulation->system->connection_count; i++) {
        const epg_system_connection_t *facts = &simulation->system->connections[i];
        if (facts->sender == index && facts->publication == publication && !send(simulation, i, time_ns)) {
            return false;
        }
    }
    return true;
}

/** True if a value of publication `index` differs from that of its last message.  The new values are then kept. */
static bool changed(member_t *member, size_t index)
{
    const epg_topic_t *topic = &target_of(member)->publications[index];
    const size_t size = topic->count * sizeof *member->monitored;
    const double *values = &member->monitored[topic->index];
    double *before = &member->published[topic->index];
    if (member->announced[index] && memcmp(values, before, size) == 0) {
        return false;
    }
    member->announced[index] = true;
    memcpy(before, values, size);
    return true;
}

/** True if publication `index` is due: after the cycle of tick `tick`, or, without a cycle, after a period. */
static bool is_due(member_t *member, size_t index, const uint64_t *tick)
{
    const epg_topic_t *topic = &target_of(member)->publications[index];
    switch (topic->trigger) {
    case EPG_TOPIC_CYCLES:
        return tick != NULL && *tick % topic->cycles == 0;
    case EPG_TOPIC_CHANGE:
        return tick != NULL && changed(member, index);
    case EPG_TOPIC_PERIOD:
    default:
        return tick == NULL;
    }
}

/** Sends the publications that are due after the cycle of tick `*tick`; NULL: those with a period. */
static bool publish_all(simulation_t *simulation, size_t index, const uint64_t *tick, uint64_t time_ns)
{
    member_t *member = &simulation->members[index];
    if (!member->unit->monitor(member->monitored)) {
        return true;
    }
    for (size_t i = 0; i < target_of(member)->publication_count; i++) {
        const bool has_values = target_of(member)->publications[i].role == EPG_TOPIC_VALUES;
        if (has_values && is_due(member, i, tick) && !publish(simulation, index, i, time_ns)) {
            return false;
        }
    }
    return true;
}

/* Events ----------------------------------------------------------------------------------------------------------- */

static bool cycle(simulation_t *simulation, const event_t *event)
{
    member_t *member = &simulation->members[event->place];
    if (member->is_stalled) {
        member_resume(member, event->time_ns);
    } else if (!member_cycle(member, event->number, event->time_ns)) {
        return false;
    }
    if (member->is_stalled) {
        const uint64_t stall_ns = member->stall_ns;
        member->stall_ns = 0;
        return add(simulation, EVENT_CYCLE, event->time_ns + stall_ns, event->place, event->number);
    }
    const uint64_t next = member_next_tick(member, event->time_ns);
    const uint64_t next_ns = member_tick_ns(member, next);
    return publish_all(simulation, event->place, &event->number, event->time_ns) &&
           add(simulation, EVENT_CYCLE, next_ns > event->time_ns ? next_ns : event->time_ns, event->place, next);
}

static bool communicate(simulation_t *simulation, const event_t *event)
{
    const member_t *member = &simulation->members[event->place];
    const uint64_t next = event->number + 1U;
    const uint64_t next_ns = member_true_ns(member, next * target_of(member)->communication_period_ns);
    return publish_all(simulation, event->place, NULL, event->time_ns) &&
           add(simulation, EVENT_PUBLICATION, next_ns, event->place, next);
}

static void apply(member_t *member, const epg_host_event_t *event)
{
    if (member->state != MEMBER_RUNS && event->kind != EPG_HOST_INPUT) {
        return;
    }
    switch (event->kind) {
    case EPG_HOST_SETPOINT:
        member->unit->receive(event->index, event->value, member_clock_ns(member, event->time_ns), event->publish);
        break;
    case EPG_HOST_ENABLE:
        member->unit->request(event->value > 0.5);
        break;
    case EPG_HOST_INPUT:
        member->unit->force((uint8_t)event->index, (epg_plant_force_t)event->value);
        break;
    case EPG_HOST_STALL:
    default:
        member->stall_ns += (uint64_t)(event->value * 1e9 + 0.5);
        break;
    }
}

/** Applies the next event of a target's file, and adds the one after it. */
static bool outside(simulation_t *simulation, const event_t *event)
{
    member_t *member = &simulation->members[event->place];
    apply(member, &member->events.events[event->number]);
    const uint64_t next = event->number + 1U;
    return next == member->events.count ||
           add(simulation, EVENT_OUTSIDE, member->events.events[next].time_ns, event->place, next);
}

static bool fail(simulation_t *simulation, const event_t *event)
{
    const failure_t *failure = &simulation->failures[event->place];
    member_t *member = &simulation->members[failure->target];
    switch (failure->kind) {
    case FAILURE_DIE:
        member_die(member, event->time_ns);
        return true;
    case FAILURE_HANG:
        member->state = member->state == MEMBER_RUNS ? MEMBER_HANGS : member->state;
        return true;
    case FAILURE_RESTART:
        return member_restart(member, event->time_ns) && begin(simulation, failure->target);
    case FAILURE_STALL:
        member->stall_ns += member->state == MEMBER_RUNS ? failure->duration_ns : 0;
        return true;
    case FAILURE_OFFLINE:
    case FAILURE_ONLINE:
    default:
        member->offline = failure->kind == FAILURE_OFFLINE;
        return true;
    }
}

/** True if the cycle or publication belongs to a target that runs. */
static bool is_alive(const simulation_t *simulation, const event_t *event)
{
    const member_t *member = &simulation->members[event->place];
    return member->state == MEMBER_RUNS && member->life == event->life;
}

static bool happen(simulation_t *simulation, event_t *event)
{
    bool good = true;
    switch (event->kind) {
    case EVENT_FAILURE:
        good = fail(simulation, event);
        break;
    case EVENT_OUTSIDE:
        good = outside(simulation, event);
        break;
    case EVENT_ARRIVAL:
        arrive(simulation, event);
        break;
    case EVENT_CYCLE:
        good = !is_alive(simulation, event) || cycle(simulation, event);
        break;
    case EVENT_PUBLICATION:
    default:
        good = !is_alive(simulation, event) || communicate(simulation, event);
        break;
    }
    free(event->message);
    return good;
}

size_t simulation_target(const epg_system_t *system, const char *name, size_t length)
{
    size_t index = 0;
    while (index < system->target_count &&
           (strlen(system->targets[index].name) != length || strncmp(system->targets[index].name, name, length) != 0)) {
        index++;
    }
    return index;
}

bool simulate(simulation_t *simulation)
{
    bool good = true;
    for (size_t i = 0; i < simulation->system->target_count && good; i++) {
        const member_t *member = &simulation->members[i];
        good = begin(simulation, i) &&
               (member->events.count == 0 || add(simulation, EVENT_OUTSIDE, member->events.events[0].time_ns, i, 0));
    }
    for (size_t i = 0; i < simulation->failure_count && good; i++) {
        good = add(simulation, EVENT_FAILURE, simulation->failures[i].time_ns, i, 0);
    }
    event_t event;
    while (good && queue_take(&simulation->queue, &event)) {
        good = happen(simulation, &event) && !simulation->plant.has_diverged;
    }
    if (good && simulation->plant.model != NULL) {
        plant_advance(&simulation->plant, simulation->end_ns - 1U);
        good = !simulation->plant.has_diverged;
    }
    queue_free(&simulation->queue);
    return good;
}
