/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The communication side of the host.
 */
#include "communication.h"

#include <stdlib.h>

#include "epg/plant.h"
#include "files.h"
#include "number.h"

enum { FLUSH_PERIOD_NS = 500 * 1000 * 1000 };

bool epg_host_communication_start(epg_host_communication_t *communication, const epg_target_t *target,
                                  const epg_host_events_t *events, uint64_t end_ns, FILE *topics)
{
    const size_t count = target->application->monitor_count;
    *communication = (epg_host_communication_t){
        .target = target,
        .events = events,
        .end_ns = end_ns,
        .topics = topics,
        .values = calloc(count > 0 ? count : 1, sizeof(double)),
        .next_publication_ns = target->publication_count > 0 && target->communication_period_ns > 0 ? 0 : UINT64_MAX};
    if (communication->values == NULL) {
        fputs("error: not enough memory for the publications\n", stderr);
        return false;
    }
    if (topics != NULL) {
        fputs("time,topic,value\n", topics);
    }
    return true;
}

static uint64_t next_event_ns(const epg_host_communication_t *communication)
{
    const epg_host_events_t *events = communication->events;
    return communication->next_event < events->count ? events->events[communication->next_event].time_ns : UINT64_MAX;
}

uint64_t epg_host_communication_next(const epg_host_communication_t *communication)
{
    const uint64_t event_ns = next_event_ns(communication);
    const uint64_t publication_ns = communication->next_publication_ns;
    const uint64_t next_ns = event_ns < publication_ns ? event_ns : publication_ns;
    return next_ns < communication->end_ns ? next_ns : UINT64_MAX;
}

/** Applies the next event at `time_ns`. */
static void deliver(epg_host_communication_t *communication, uint64_t time_ns)
{
    const epg_host_event_t *event = &communication->events->events[communication->next_event];
    communication->next_event++;
    switch (event->kind) {
    case EPG_HOST_SETPOINT:
        epg_control_receive(communication->target->control, event->index, event->value,
                            communication->start_ns + time_ns, event->publish);
        break;
    case EPG_HOST_ENABLE:
        if (event->value > 0.5) {
            epg_control_enable(communication->target->control, EPG_ENABLE_ANY);
        } else {
            epg_stop(communication->target->control, EPG_STOP_SCENARIO);
        }
        break;
    case EPG_HOST_INPUT:
        epg_plant_input_force((uint8_t)event->index, (epg_plant_force_t)event->value);
        break;
    case EPG_HOST_STALL:
    default:
        communication->stall_ns += (uint64_t)(event->value * 1e9 + 0.5);
        break;
    }
}

/** Publishes the newest values, with the time `time_ns`.  Does nothing before the first cycle. */
static void publish(epg_host_communication_t *communication, uint64_t time_ns)
{
    const epg_target_t *target = communication->target;
    if (!epg_control_monitor(target->control, communication->values) || communication->topics == NULL) {
        return;
    }
    for (size_t i = 0; i < target->publication_count; i++) {
        const epg_topic_t *topic = &target->publications[i];
        if (topic->role != EPG_TOPIC_VALUES) {
            continue;
        }
        epg_target_publishing(target, i);
        for (size_t k = 0; k < topic->count; k++) {
            epg_host_write_number(communication->topics, epg_host_seconds(time_ns));
            fprintf(communication->topics, ",%s,", epg_topic_value_name(topic, k));
            epg_host_write_number(communication->topics, communication->values[topic->index + k]);
            fputc('\n', communication->topics);
        }
    }
}

void epg_host_communicate_simulated(epg_host_communication_t *communication, uint64_t time_ns)
{
    for (;;) {
        const uint64_t next_ns = epg_host_communication_next(communication);
        const bool event = next_ns == next_event_ns(communication);
        if (next_ns == UINT64_MAX || next_ns > time_ns || (next_ns == time_ns && !event)) {
            return;
        }
        if (event) {
            deliver(communication, next_ns);
        } else {
            publish(communication, next_ns);
            communication->next_publication_ns += communication->target->communication_period_ns;
        }
    }
}

void epg_host_communicate_realtime(epg_host_communication_t *communication, uint64_t time_ns)
{
    epg_control_alive(communication->target->control);
    while (next_event_ns(communication) <= time_ns && next_event_ns(communication) < communication->end_ns) {
        deliver(communication, time_ns);
    }
    if (communication->next_publication_ns <= time_ns && communication->next_publication_ns < communication->end_ns) {
        publish(communication, time_ns);
        /* The schedule is fixed: a late publication does not delay the later ones, and a lost one is not repeated. */
        const uint64_t period_ns = communication->target->communication_period_ns;
        communication->next_publication_ns +=
            ((time_ns - communication->next_publication_ns) / period_ns + 1) * period_ns;
    }
    if (communication->topics != NULL && communication->flush_ns <= time_ns) {
        epg_host_files_flush(communication->topics);
        communication->flush_ns = time_ns + FLUSH_PERIOD_NS;
    }
}

void epg_host_communication_end(epg_host_communication_t *communication)
{
    free(communication->values);
    communication->values = NULL;
}
