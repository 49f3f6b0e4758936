/*
 * The communication side alone, between a setpoint file and a control object that records its calls.
 *
 *     delivery FILE simulated|realtime END_MS TIME_MS...
 *
 * polls the communication at each of the times and prints the setpoints and topics that it delivers and publishes.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "epg/plant.h"
#include "epg/port.h"
#include "files/communication.h"

enum { START_NS = 5000 };

bool epg_control_receive(epg_control_t *control, size_t index, double value, uint64_t received_ns, bool publish)
{
    (void)control;
    printf("setpoint %u = %g at %.3f ms%s\n", (unsigned)index, value, (double)(received_ns - START_NS) / 1e6,
           publish ? ", published" : "");
    return true;
}

void epg_control_enable(epg_control_t *control, unsigned int request)
{
    (void)control;
    (void)request;
    puts("enable");
}

void epg_stop(epg_control_t *control, epg_stop_source_t source)
{
    (void)control;
    (void)source;
    puts("disable");
}

void epg_control_alive(epg_control_t *control)
{
    (void)control;
}

bool epg_control_monitor(epg_control_t *control, double *values)
{
    (void)control;
    values[0] = 1.5;
    return true;
}

static const epg_application_t application = {.name = "delivery", .monitor_count = 1};
static const epg_topic_t subscriptions[2] = {{.name = "b", .index = 1, .count = 1}, {.name = "a", .count = 1}};
static const epg_topic_t publications[1] = {{.name = "p", .count = 1}};
static epg_control_t control;
static const epg_target_t target = {
    .control = &control,
    .application = &application,
    .communication_period_ns = 10000000,
    .subscription_count = 2,
    .subscriptions = subscriptions,
    .publication_count = 1,
    .publications = publications,
};

static const epg_host_target_t host = {.target = &target};

static uint64_t milliseconds(const char *text)
{
    return (uint64_t)(atof(text) * 1e6 + 0.5);
}

int main(int argc, char **argv)
{
    epg_host_events_t events;
    epg_host_communication_t communication;
    if (argc < 4 || !epg_host_read_setpoints(argv[1], &host, false, &events)) {
        return 2;
    }
    if (!epg_host_communication_start(&communication, &target, &events, milliseconds(argv[3]), stdout)) {
        return 1;
    }
    communication.start_ns = START_NS;
    for (int i = 4; i < argc; i++) {
        printf("-- %s\n", argv[i]);
        if (strcmp(argv[2], "simulated") == 0) {
            epg_host_communicate_simulated(&communication, milliseconds(argv[i]));
        } else {
            epg_host_communicate_realtime(&communication, milliseconds(argv[i]));
        }
    }
    epg_host_communication_end(&communication);
    epg_host_free_setpoints(&events);
    return 0;
}
