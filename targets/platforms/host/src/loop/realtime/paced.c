/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Simulated time at a multiple of real time, while the target is connected to its ROS 2 network.
 *
 * The thread that simulates also serves the middleware, between two cycles.  A cycle takes no simulated time, so a slow
 * computer causes no overruns.  Messages arrive at any time, however, so two runs differ.
 */
#include <stdio.h>
#include <stdlib.h>

#include "epg/host_log.h"
#include "epg/node.h"
#include "epg/port.h"
#include "files/files.h"
#include "files/number.h"
#include "loop/run.h"
#include "port/clock.h"

enum { CLOCK_PERIOD_NS = 10 * 1000 * 1000 /* simulated time between two messages on /clock */ };

static const uint64_t WRITE_PERIOD_NS = 500 * 1000 * 1000; /* real time from one write of the files to the next */
static const uint64_t LAG_NS = 100 * 1000 * 1000;          /* real time that a run may be late and still catch up */

/** QoS as rclcpp::ClockQoS: nodes with `use_sim_time` subscribe best effort, and need only the newest message. */
static const epg_topic_t clock_topic = {
    .name = "/clock",
    .message = &epg_message_clock,
    .size = sizeof(int32_t) + sizeof(uint32_t),
    .qos = EPG_QOS_BEST_EFFORT,
    .depth = 1,
    .role = EPG_TOPIC_CLOCK,
    .trigger = EPG_TOPIC_PERIOD,
    .period_ns = CLOCK_PERIOD_NS,
};

bool epg_host_pace_prepare(epg_target_t *target)
{
    const size_t count = target->publication_count;
    epg_node_t *node = target->node_state;
    if (node == NULL) {
        return true; /* a middleware of the user that is not a ROS 2 node */
    }
    static unsigned char buffer[sizeof(int32_t) + sizeof(uint32_t)];
    /* Both blocks are used until the program ends. */
    epg_topic_t *topics = calloc(count + 1, sizeof *topics);
    epg_node_publication_t *states = calloc(count + 1, sizeof *states);
    if (topics == NULL || states == NULL) {
        fputs("error: not enough memory for the topic /clock\n", stderr);
        free(topics);
        free(states);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        topics[i] = target->publications[i];
    }
    topics[count] = clock_topic;
    target->publications = topics;
    target->publication_count = count + 1;
    target->simulated_time = true;
    node->publications = states;
    if (node->buffer_size < sizeof buffer) {
        node->buffer = buffer;
        node->buffer_size = sizeof buffer;
    }
    return true;
}

void epg_host_pace_start(epg_host_run_t *run)
{
    if (epg_host_logs(EPG_HOST_LOG_INFO)) {
        fprintf(stderr, "%s: simulated time at ", run->host->target->application->name);
        epg_host_write_number(stderr, run->pace);
        fputs(" times real time: this run is not repeatable\n", stderr);
    }
    epg_host_services_start(&run->services);
    run->pace_start_ns = epg_host_monotonic_ns();
    run->write_ns = run->pace_start_ns;
}

void epg_host_pace_wait(epg_host_run_t *run, uint64_t tick_ns)
{
    const uint64_t due_ns = run->pace_start_ns + (uint64_t)((double)tick_ns / run->pace);
    uint64_t now_ns = epg_host_monotonic_ns();
    if (now_ns > due_ns + LAG_NS) {
        run->pace_start_ns += now_ns - due_ns;
    }
    if (now_ns >= run->write_ns) {
        epg_host_trace_write(&run->trace);
        if (run->communication.topics != NULL) {
            epg_host_files_flush(run->communication.topics);
        }
        run->write_ns = now_ns + WRITE_PERIOD_NS;
    }
    epg_control_alive(run->host->target->control);
    do {
        epg_host_services_serve(&run->services, due_ns);
        now_ns = epg_host_monotonic_ns();
        const uint64_t time_ns = (uint64_t)((double)(now_ns - run->pace_start_ns) * run->pace);
        if (now_ns < due_ns && time_ns > epg_port_time_ns()) { /* after a `$stall` it is less */
            epg_host_clock_simulate(time_ns);
        }
    } while (now_ns < due_ns && !epg_host_interrupted);
}

void epg_host_pace_end(epg_host_run_t *run)
{
    epg_host_services_stop(&run->services);
}
