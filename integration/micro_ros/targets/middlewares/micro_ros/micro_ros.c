/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The states of the connection to the agent.
 *
 * | state    | action                                                      | next state                               |
 * |----------|-------------------------------------------------------------|------------------------------------------|
 * | waiting  | pings every 0.2 s; after an answer, requests session, node  | granted: creating                        |
 * | creating | requests publishers and subscriptions, one per poll         | all exist: running; refused: waiting     |
 * | running  | exchanges messages; pings every 0.2 s; asks for the time    | the agent is silent for 1 s, or a stream |
 * |          | when epg/wall_clock.h says so                               | is full for 2 s: waiting                 |
 */
#include "micro_ros.h"

#include <string.h>

#include <rcl/error_handling.h>
#include <rmw_microros/rmw_microros.h>

#include "epg/node.h"
#include "epg/port.h"
#include "micro_ros_clock.h"
#include "micro_ros_entities.h"
#include "micro_ros_system.h"
#include "micro_ros_transport.h"

#define MS ((uint64_t)1000000)

static const uint64_t PING_NS = 200 * MS;
static const uint64_t SILENCE_NS = 1000 * MS; /* silence after which the agent counts as lost */
static const uint64_t REFUSED_NS = 2000 * MS; /* time from a refusal to the next attempt */
static const uint64_t FULL_NS = 150 * MS;     /* time with a full reliable stream until a pause of REST_NS */
static const uint64_t STUCK_NS = 2000 * MS;   /* time with a full reliable stream until the session is given up */
/* The client library asks the agent for missing frames only if the library was not called for 100 ms. */
static const uint64_t REST_NS = 105 * MS;

enum { PONG_MS = 50, FRAMES_PER_POLL = 32 };

typedef enum state { WAITING, CREATING, RUNNING } state_t;

/** The only node of an executable. */
static struct {
    const epg_target_t *target;
    const epg_stream_t *stream;
    const epg_micro_ros_options_t *options;
    epg_node_t *node;
    epg_micro_ros_entities_t entities;
    epg_micro_ros_question_t question; /* of this connection, or still of the one before it */
    state_t state;
    bool usable; /* libmicroros has accepted the memory and the stream */
    bool again;  /* the node was running before */

    uint64_t now_ns;   /* board time of this poll */
    uint64_t ping_ns;  /* next ping */
    uint64_t alive_ns; /* last answer of the agent */
    uint64_t full_ns;  /* since then, the reliable stream has been full; 0: it has room */
    uint64_t asked_ns; /* end of the last pause, or the instant at which the stream became full */
    uint64_t rest_ns;  /* end of the present pause, in which the library is not called */
} ros;

static bool agent_answers(void)
{
    ros.ping_ns = ros.now_ns + PING_NS;
    return rmw_uros_ping_agent(PONG_MS, 1) == RMW_RET_OK;
}

static void lose_agent(uint64_t pause_ns)
{
    epg_micro_ros_entities_drop(&ros.entities);
    ros.state = WAITING;
    ros.ping_ns = epg_port_time_ns() + pause_ns;
}

/* Topics ------------------------------------------------------------------------------------------------------- */

/** The `send` function of the node: puts a message into a stream of libmicroros, completely or not at all. */
static bool send_message(size_t publication, const void *message, size_t size)
{
    bool taken = false;
    const epg_micro_ros_sent_t sent = {.data = message, .size = size, .taken = &taken};
    if (ros.state != RUNNING) {
        return false;
    }
    /* rcl_publish() also returns an error if the agent has not confirmed yet. */
    if (rcl_publish(&ros.options->publishers[publication], &sent, NULL) != RCL_RET_OK) {
        rcl_reset_error();
    }
    if (ros.target->publications[publication].qos == EPG_QOS_RELIABLE) {
        if (taken) {
            ros.full_ns = 0;
        } else if (ros.full_ns == 0) {
            ros.full_ns = ros.now_ns;
            ros.asked_ns = ros.now_ns;
        }
    }
    return taken;
}

static void take_message(size_t index)
{
    epg_micro_ros_received_t message = {.data = ros.options->received, .capacity = ros.options->received_size};
    if (rcl_take(&ros.options->subscriptions[index], &message, NULL, NULL) == RCL_RET_OK) {
        epg_node_receive(ros.node, index, message.data, message.size, 0, ros.now_ns);
    } else {
        ros.node->malformed++; /* the message is larger than any valid one */
        rcl_reset_error();
    }
}

/** Handles at most one frame.  Returns true if there may be more. */
static bool take_frame(void)
{
    static const rmw_time_t AT_ONCE = {0, 0};
    rmw_subscriptions_t subscriptions = {.subscriber_count = ros.target->subscription_count,
                                         .subscribers = ros.options->ready};
    for (size_t i = 0; i < subscriptions.subscriber_count; i++) {
        ros.options->ready[i] = rcl_subscription_get_rmw_handle(&ros.options->subscriptions[i])->data;
    }
    (void)epg_micro_ros_transport_heard();
    const bool any = rmw_wait(&subscriptions, NULL, NULL, NULL, NULL, NULL, &AT_ONCE) == RMW_RET_OK;
    for (size_t i = 0; any && i < subscriptions.subscriber_count; i++) {
        if (ros.options->ready[i] != NULL) {
            take_message(i);
        }
    }
    return epg_micro_ros_transport_heard() || any;
}

static void take_frames(void)
{
    epg_node_listen(ros.node);
    for (int i = 0; i < FRAMES_PER_POLL && take_frame(); i++) {
    }
}

/* States ------------------------------------------------------------------------------------------------------- */

static void poll_waiting(void)
{
    if (ros.now_ns < ros.ping_ns || !agent_answers()) {
        return;
    }
    if (!epg_micro_ros_entities_connect(&ros.entities, epg_node_key(ros.node))) {
        lose_agent(REFUSED_NS);
        return;
    }
    ros.state = CREATING;
}

static void poll_creating(void)
{
    bool complete = false;
    if (!epg_micro_ros_entities_make(&ros.entities, &complete)) {
        lose_agent(REFUSED_NS);
    } else if (complete) {
        ros.now_ns = epg_port_time_ns();
        ros.state = RUNNING;
        ros.alive_ns = ros.now_ns;
        ros.ping_ns = ros.now_ns + PING_NS;
        ros.full_ns = 0;
        ros.rest_ns = 0;
        if (ros.again) {
            epg_control_count_reconnect(ros.target->control);
        }
        ros.again = true;
        epg_clock_connected(&ros.node->clock, ros.now_ns);
        epg_node_connected(ros.node, ros.now_ns);
    }
}

/** Pings the agent when that is due.  Returns false if the session was given up. */
static bool check_agent(void)
{
    if (ros.now_ns >= ros.ping_ns && agent_answers()) {
        ros.alive_ns = ros.now_ns;
    }
    const bool stuck = ros.full_ns != 0 && ros.now_ns >= ros.full_ns + STUCK_NS;
    if (stuck || ros.now_ns >= ros.alive_ns + SILENCE_NS) {
        lose_agent(0);
        return false;
    }
    return true;
}

static void poll_running(void)
{
    if (ros.now_ns < ros.rest_ns) {
        return;
    }
    take_frames();
    if (!check_agent()) {
        return;
    }
    const bool busy = epg_node_poll(ros.node, ros.now_ns);
    epg_micro_ros_clock_poll(&ros.question, &ros.node->clock, ros.now_ns, busy);
    if (ros.full_ns != 0 && ros.now_ns >= ros.asked_ns + FULL_NS) {
        ros.rest_ns = ros.now_ns + REST_NS;
        ros.asked_ns = ros.rest_ns;
    }
}

/* The middleware ----------------------------------------------------------------------------------------------- */

static void start(const epg_target_t *target, const epg_stream_t *stream)
{
    /* A run before this one may have ended in any state. */
    epg_micro_ros_entities_drop(&ros.entities);
    memset(&ros, 0, sizeof ros);
    ros.target = target;
    ros.stream = stream;
    ros.options = target->options;
    ros.node = target->node_state;
    ros.state = WAITING;
    ros.usable = epg_micro_ros_memory_start(ros.options->memory, ros.options->memory_size) &&
                 epg_micro_ros_transport_start(stream);
    epg_node_start(ros.node, target, send_message);
    ros.entities = (epg_micro_ros_entities_t){.node = ros.node, .options = ros.options};
}

static void poll(uint64_t now_ns)
{
    ros.now_ns = now_ns;
    if (!ros.usable) {
        return;
    }
    if (!ros.stream->connected(ros.stream->context)) {
        if (ros.state == RUNNING) {
            take_frames(); /* the agent's last messages: a request to disable can be among them */
        }
        if (ros.state != WAITING) {
            lose_agent(0);
        }
        epg_micro_ros_transport_drop();
    } else if (ros.state == WAITING) {
        poll_waiting();
    } else if (ros.state == CREATING) {
        poll_creating();
    } else {
        poll_running();
    }
}

static void stop(void)
{
    epg_micro_ros_entities_drop(&ros.entities);
    ros.state = WAITING;
}

static const char *state(void)
{
    static const char *const names[] = {[WAITING] = "waiting", [CREATING] = "creating", [RUNNING] = "running"};
    return names[ros.state];
}

const epg_middleware_t epg_micro_ros = {.start = start, .poll = poll, .stop = stop, .state = state};
