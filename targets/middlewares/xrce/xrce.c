/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The states of the connection to the agent.
 *
 * | state    | action                                                     | next state                                |
 * |----------|------------------------------------------------------------|-------------------------------------------|
 * | waiting  | requests a session every 0.2 s, later every 0.5 s          | accepted: creating                        |
 * | creating | requests node, topics, writers and readers, one by one     | all exist: running; refused, or no answer |
 * |          |                                                            | within 2 s: waiting, with longer          |
 * |          |                                                            | intervals                                 |
 * | running  | exchanges messages, requests of services and replies       | the session is unknown to the agent, or   |
 * |          |                                                            | the agent silent for 4 s: waiting         |
 *
 * In the last two states it pings every 0.1 s, and asks for the time when epg/wall_clock.h says so.  An agent that was
 * restarted answers the first ping that it does not know the session.  A silent agent may be busy with the end of other
 * clients, and still know it; therefore no other limit counts while the agent is silent.
 *
 * The client library is called so that none of its functions waits.  With a timeout of 0, a function sends the frames
 * that are ready, takes one frame if there is one, and returns.
 */
#include "xrce.h"

#include <string.h>

#include "epg/node.h"
#include "epg/port.h"
#include "xrce_entities.h"
#include "xrce_guard.h"
#include "xrce_link.h"
#include "xrce_services.h"

#define MS ((uint64_t)1000000)

static const uint64_t FIRST_ATTEMPT_NS = 200 * MS;  /* interval between two requests for a session */
static const uint64_t LAST_ATTEMPT_NS = 500 * MS;   /* the same after several requests */
static const uint64_t MOST_PATIENCE_NS = 2000 * MS; /* the same for an agent that accepted and then was too slow */
static const uint64_t REFUSED_NS = 2000 * MS;       /* the same after the agent has refused a request */
static const uint64_t ANSWER_NS = 2000 * MS;        /* longest time for one answer in the state `creating` */
static const uint64_t PING_NS = 100 * MS;
static const uint64_t QUIET_NS = 1000 * MS; /* silence without a doubt: even with noise, one of ten pings arrives */
/* Silence of a lost agent.  An agent that deletes a client serves no other one, for 0.1 s per reader and service: 1.2 s
   for a board with 3 readers and the 9 services.  In 4 s, three such boards can leave. */
static const uint64_t SILENCE_NS = 4000 * MS;
static const uint64_t STUCK_NS = 2000 * MS;   /* time without progress of a stream, though the agent answers pings */
static const uint64_t HEARTBEAT_NS = 50 * MS; /* time from an unacknowledged frame to the request for its ACKNACK */

enum { FRAMES_PER_POLL = 32, DROPPED_PER_FRAME = 8 };

enum { TIMESTAMP = 0x0E }; /* id of a submessage: DDS-XRCE 1.0, 8.3.5 */

/** Bytes on the line.  As many or more that one poll has written are sent by the next one, so that both are short. */
enum { LONG_MESSAGES = 512 };

/** The progress of a reliable stream: a number that grows until all frames are acknowledged or received. */
typedef struct progress {
    uint16_t number;
    uint64_t since_ns; /* last instant at which the number grew; 0: no frame is outstanding */
} progress_t;

/** The only client of an executable. */
static struct {
    const epg_target_t *target;
    const epg_stream_t *stream;
    const epg_xrce_options_t *options;
    epg_node_t *node;
    epg_xrce_link_t link;
    epg_xrce_guard_t guard;
    epg_xrce_entities_t entities;
    epg_xrce_services_t services;
    uxrCommunication communication;
    uxrSession session;
    uxrStreamId reliable; /* output streams */
    uxrStreamId best_effort;
    size_t buffered; /* bytes that the frames in the streams will take on the line */
    epg_xrce_status_t status;

    uint64_t now_ns;      /* board time of this poll */
    uint64_t attempt_ns;  /* next request for a session */
    uint64_t interval_ns; /* interval from that request to the one after it */
    uint64_t patience_ns; /* shortest interval between requests, FIRST_ATTEMPT_NS ... MOST_PATIENCE_NS */
    uint64_t answer_ns;   /* deadline of the agent's answer */
    uint64_t ping_ns;     /* next ping */
    uint64_t alive_ns;    /* last sign of life of the agent */
    progress_t sent;      /* our reliable stream, until the agent has acknowledged all frames */
    progress_t received;  /* the agent's reliable stream, until all announced frames are here */
    progress_t replies;   /* the same for the stream of the services */
    progress_t requests;
    uint16_t asked_for;    /* last acknowledged number when `heartbeat_ns` was set */
    uint64_t heartbeat_ns; /* next request for an acknowledgement */
} client;

/* The library's transport -------------------------------------------------------------------------------------- */

static bool send_frame(void *instance, const uint8_t *data, size_t size)
{
    (void)instance;
    const bool sent = epg_xrce_link_send(&client.link, data, size);
    client.status.unsent += sent ? 0U : 1U; /* a reliable frame is sent again when the agent asks for it */
    return sent;
}

static bool receive_frame(void *instance, uint8_t **data, size_t *size, int timeout)
{
    (void)instance;
    (void)timeout; /* it is always 0 */
    for (int i = 0; i < DROPPED_PER_FRAME; i++) {
        const size_t received = epg_xrce_link_receive(&client.link);
        if (received == 0) {
            return false;
        }
        *size = epg_xrce_guard(&client.guard, client.link.frame, received);
        if (*size > 0) {
            *data = client.link.frame;
            client.alive_ns = client.now_ns;
            return true;
        }
    }
    return false;
}

static uint8_t transport_error(void)
{
    return 0;
}

/* Callbacks of the library ------------------------------------------------------------------------------------- */

static void on_status(uxrSession *session, uxrObjectId object, uint16_t request, uint8_t status, void *context)
{
    (void)session;
    (void)object;
    (void)context;
    epg_xrce_entities_answer(&client.entities, request, status);
}

static void on_sample(uxrSession *session, uxrObjectId object, uint16_t request, uxrStreamId stream, ucdrBuffer *buffer,
                      uint16_t length, void *context)
{
    (void)session;
    (void)request;
    (void)stream;
    (void)context;
    const size_t left = ucdr_buffer_remaining(buffer);
    if (client.status.state == EPG_XRCE_RUNNING && object.id > 0) {
        epg_node_receive(client.node, (size_t)object.id - 1, buffer->iterator, length < left ? length : left, 0,
                         client.now_ns);
    }
}

/**
 * Takes the agent's answer to a request for the time.  All times are in nanoseconds.  `asked` and `came` are in board
 * time, the two others in the agent's time.  As in NTP, both ways are taken to be equally long.
 */
static void on_time(uxrSession *session, int64_t came, int64_t agent_received, int64_t agent_sent, int64_t asked,
                    void *context)
{
    (void)session;
    (void)context;
    const int64_t round_trip = came - asked - (agent_sent - agent_received);
    if (asked > came || round_trip < 0) {
        return;
    }
    const int64_t ahead = (agent_received - asked + (agent_sent - came)) / 2;
    epg_clock_answer(&client.node->clock, (uint64_t)(came + ahead), (uint64_t)came, (uint64_t)round_trip);
}

/* Reliable streams --------------------------------------------------------------------------------------------- */

/** Returns true if frames of a stream are outstanding and it has made no progress for `longest_ns`. */
static bool is_stuck(progress_t *progress, uint16_t number, bool outstanding, uint64_t longest_ns)
{
    if (!outstanding) {
        progress->since_ns = 0;
    } else if (progress->since_ns == 0 || progress->number != number) {
        progress->since_ns = client.now_ns;
        progress->number = number;
    }
    return outstanding && client.now_ns >= progress->since_ns + longest_ns;
}

/**
 * Returns true if a stream makes no progress, though the agent answers pings.  The agent has then lost frames that this
 * side takes for delivered, and only a new session helps.
 */
static bool streams_are_stuck(void)
{
    const uxrOutputReliableStream *output = &client.session.streams.output_reliable[0];
    const uxrInputReliableStream *input = &client.session.streams.input_reliable[0];
    const bool sent = is_stuck(&client.sent, output->last_acknown, output->last_acknown != output->last_sent, STUCK_NS);
    const bool received =
        is_stuck(&client.received, input->last_handled, input->last_handled != input->last_announced, STUCK_NS);
    const bool replies = is_stuck(&client.replies, client.services.unacknowledged,
                                  client.services.unacknowledged != client.services.next, STUCK_NS);
    const bool requests =
        is_stuck(&client.requests, client.services.expected, epg_xrce_services_lack_frames(&client.services), STUCK_NS);
    return sent || received || replies || requests;
}

/**
 * Makes the library ask for an acknowledgement in time.  On its own it asks only if it was not called for 100 ms.  The
 * agent's answer names the missing frames, and the library sends them again.
 */
static void time_heartbeat(void)
{
    uxrOutputReliableStream *stream = &client.session.streams.output_reliable[0];
    if (stream->last_acknown == stream->last_sent || client.asked_for != stream->last_acknown) {
        client.asked_for = stream->last_acknown;
        client.heartbeat_ns = client.now_ns + HEARTBEAT_NS;
    } else if (client.now_ns >= client.heartbeat_ns) {
        client.heartbeat_ns = client.now_ns + HEARTBEAT_NS;
        stream->next_heartbeat_timestamp = 0;
    }
}

/* States ------------------------------------------------------------------------------------------------------- */

static void wait_for_agent(uint64_t first_ns)
{
    client.status.state = EPG_XRCE_WAITING;
    client.guard.open = false;
    client.guard.reading = false;
    epg_xrce_services_start(&client.services);
    client.attempt_ns = client.now_ns + first_ns;
    client.interval_ns = client.patience_ns;
    client.session.info.last_requested_status = UXR_STATUS_NONE;
}

static void lose_agent(uint64_t first_ns)
{
    client.status.lost++;
    wait_for_agent(first_ns);
}

/**
 * Gives up an agent that accepted the session and then did not answer.
 *
 * Each request for a session ends the session before.  A slow agent may still be busy with a queue of such requests, so
 * the interval between them becomes longer.
 */
static void lose_slow_agent(void)
{
    const uint64_t longer_ns = client.patience_ns * 4;
    client.patience_ns = longer_ns < MOST_PATIENCE_NS ? longer_ns : MOST_PATIENCE_NS;
    lose_agent(client.patience_ns);
}

/**
 * Ends the session at the agent.  The message contains the client's key instead of the session's id, so the agent finds
 * the client under any address.  An agent that does not know the client ignores the message.
 */
static void say_goodbye(void)
{
    client.session.info.id = 0x01;
    (void)uxr_delete_session_retries(&client.session, 0);
    client.session.info.id = EPG_XRCE_SESSION_ID;
}

/**
 * Requests a session.  Before that, it ends an older session of this client: readers that the agent had kept would
 * deliver the old samples that they have collected.
 */
static void ask_for_session(void)
{
    say_goodbye();
    (void)uxr_create_session_retries(&client.session, 0);
    client.buffered = 0;
    client.sent.since_ns = 0;
    client.received.since_ns = 0;
    client.replies.since_ns = 0;
    client.requests.since_ns = 0;
    client.attempt_ns = client.now_ns + client.interval_ns;
    const uint64_t longest_ns = client.patience_ns > LAST_ATTEMPT_NS ? client.patience_ns : LAST_ATTEMPT_NS;
    client.interval_ns = client.interval_ns * 3 / 2 < longest_ns ? client.interval_ns * 3 / 2 : longest_ns;
}

static void poll_waiting(void)
{
    const uint8_t status = client.session.info.last_requested_status;
    if (status == UXR_STATUS_OK) {
        client.status.state = EPG_XRCE_CREATING;
        client.guard.open = true;
        client.guard.pong = false;
        client.guard.unknown = false;
        client.alive_ns = client.now_ns;
        client.answer_ns = client.now_ns + ANSWER_NS;
        client.ping_ns = client.now_ns + PING_NS;
        epg_xrce_entities_start(&client.entities);
        epg_clock_connected(&client.node->clock, client.now_ns);
    } else if (status != UXR_STATUS_NONE) {
        client.status.refused++;
        wait_for_agent(REFUSED_NS);
    } else if (client.now_ns >= client.attempt_ns) {
        ask_for_session();
    }
}

/**
 * Lets no limit run out while the agent is silent, except that of the silence.  It is busy, or gone.  The messages that
 * follow have waited in it.
 */
static void wait_in_silence(void)
{
    client.answer_ns = client.now_ns + ANSWER_NS;
    client.sent.since_ns = 0;
    client.received.since_ns = 0;
    client.replies.since_ns = 0;
    client.requests.since_ns = 0;
    epg_node_delayed(client.node, client.now_ns);
}

/** Pings the agent when that is due.  Returns false if the session is lost. */
static bool check_agent(void)
{
    if (client.guard.pong) {
        client.guard.pong = false;
        client.alive_ns = client.now_ns;
    }
    if (client.now_ns >= client.alive_ns + QUIET_NS) {
        wait_in_silence();
    }
    /* In the state `creating`, ANSWER_NS is the limit of the streams. */
    const bool lost = client.now_ns >= client.alive_ns + SILENCE_NS ||
                      (client.status.state == EPG_XRCE_RUNNING && streams_are_stuck());
    if (client.guard.unknown || lost) {
        lose_agent(0);
        return false;
    }
    if (client.now_ns >= client.ping_ns) {
        client.ping_ns = client.now_ns + PING_NS;
        (void)uxr_ping_agent_session(&client.session, 0, 1);
    }
    return true;
}

/**
 * Asks the agent for the time when that is due.  `busy`: this poll has sent other messages, so the request waits.
 *
 * The library's function for it takes a received frame, too, which would make the poll longer.
 */
static void ask_for_time(bool busy)
{
    const bool pinged = client.ping_ns == client.now_ns + PING_NS;
    if (!epg_clock_poll(&client.node->clock, client.now_ns, busy || pinged)) {
        return;
    }
    const uint64_t asked_ns = epg_port_time_ns();
    const uint32_t time[2] = {(uint32_t)(asked_ns / 1000000000U), (uint32_t)(asked_ns % 1000000000U)};
    uint8_t frame[8 + sizeof time] = {EPG_XRCE_SESSION_ID, 0, 0, 0, TIMESTAMP, 1, sizeof time, 0};
    memcpy(frame + 8, time, sizeof time);
    (void)send_frame(NULL, frame, sizeof frame);
}

static void start_running(void)
{
    client.status.state = EPG_XRCE_RUNNING;
    client.patience_ns = FIRST_ATTEMPT_NS;
    client.alive_ns = client.now_ns;
    client.status.connections++;
    if (client.status.connections > 1) {
        epg_control_count_reconnect(client.target->control);
    }
    epg_node_connected(client.node, client.now_ns);
}

/** Returns true if it has sent a request. */
static bool poll_creating(void)
{
    const size_t step = client.entities.step;
    const epg_xrce_progress_t progress = epg_xrce_entities_poll(&client.entities);
    if (progress == EPG_XRCE_REFUSED) {
        client.status.refused++;
        lose_agent(REFUSED_NS);
        return false;
    }
    client.guard.reading = epg_xrce_entities_exist(&client.entities);
    if (client.entities.step != step) {
        client.answer_ns = client.now_ns + ANSWER_NS;
    }
    if (progress == EPG_XRCE_COMPLETE) {
        start_running();
    } else if (client.now_ns >= client.answer_ns) {
        lose_slow_agent();
    }
    return client.entities.step != step;
}

/* Topics ------------------------------------------------------------------------------------------------------- */

/** The `send` function of the node: puts a message into a stream, completely or not at all. */
static bool send_message(size_t publication, const void *message, size_t size)
{
    const bool reliable = client.target->publications[publication].qos == EPG_QOS_RELIABLE;
    const uxrStreamId stream = reliable ? client.reliable : client.best_effort;
    const size_t cost = epg_xrce_link_cost(&client.link, message, size) + 2 * EPG_XRCE_OVERHEAD;
    if (client.status.state != EPG_XRCE_RUNNING || size + EPG_XRCE_OVERHEAD > client.options->output_frame ||
        epg_xrce_link_room(&client.link) < client.buffered + cost) {
        return false;
    }
    const uxrObjectId writer = epg_xrce_writer(publication);
    uint8_t *bytes = (uint8_t *)(uintptr_t)message; /* the library only reads it */
    uint16_t request = uxr_buffer_topic(&client.session, stream, writer, bytes, size);
    if (request == UXR_INVALID_REQUEST_ID && !reliable) {
        uxr_flash_output_streams(&client.session); /* the frame is full: send it and begin another one */
        client.buffered = 0;
        request = uxr_buffer_topic(&client.session, stream, writer, bytes, size);
    }
    client.buffered += request != UXR_INVALID_REQUEST_ID ? cost : 0U;
    return request != UXR_INVALID_REQUEST_ID;
}

/* The middleware ----------------------------------------------------------------------------------------------- */

static void start_session(void)
{
    const epg_xrce_options_t *options = client.options;
    client.communication = (uxrCommunication){
        .send_msg = send_frame,
        .recv_msg = receive_frame,
        .comm_error = transport_error,
        /* The library reports 4 bytes less than this to the agent. */
        .mtu = (uint16_t)(options->input_frame + 4),
    };
    uxr_init_session(&client.session, &client.communication, epg_node_key(client.node));
    client.session.info.id = EPG_XRCE_SESSION_ID;
    uxr_set_status_callback(&client.session, on_status, NULL);
    uxr_set_topic_callback(&client.session, on_sample, NULL);
    uxr_set_time_callback(&client.session, on_time, NULL);
    client.reliable = uxr_create_output_reliable_stream(&client.session, options->output,
                                                        EPG_XRCE_HISTORY_SIZE(options->history, options->output_frame),
                                                        options->history);
    client.best_effort =
        uxr_create_output_best_effort_stream(&client.session, options->best_effort, options->output_frame);
    client.entities = (epg_xrce_entities_t){
        .node = client.node,
        .session = &client.session,
        .requests = client.reliable,
        .reliable = uxr_create_input_reliable_stream(&client.session, options->input,
                                                     EPG_XRCE_HISTORY_SIZE(options->history, options->input_frame),
                                                     options->history),
        .best_effort = uxr_create_input_best_effort_stream(&client.session),
    };
}

static void start(const epg_target_t *target, const epg_stream_t *stream)
{
    memset(&client, 0, sizeof client);
    client.target = target;
    client.stream = stream;
    client.options = target->options;
    client.node = target->node_state;
    client.guard.session = &client.session;
    client.guard.services = target->service_count > 0 ? &client.services : NULL;
    client.services.node = client.node;
    client.services.link = &client.link;
    client.services.frame = client.options->best_effort;
    client.services.frame_size = client.options->output_frame;
    client.patience_ns = FIRST_ATTEMPT_NS;
    epg_node_start(client.node, target, send_message);
    epg_xrce_link_start(&client.link, stream, client.options->received, client.options->input_frame);
    start_session();
    wait_for_agent(0);
}

/** Handles the frames that have arrived, and sends the frames that are ready. */
static void exchange_frames(void)
{
    client.buffered = 0;
    epg_node_listen(client.node);
    for (int i = 0; i < FRAMES_PER_POLL && uxr_run_session_until_timeout(&client.session, 0); i++) {
    }
}

static void poll(uint64_t now_ns)
{
    client.now_ns = now_ns;
    client.services.now_ns = now_ns;
    if (!client.stream->connected(client.stream->context)) {
        if (client.status.state != EPG_XRCE_WAITING) {
            exchange_frames(); /* the agent's last messages: a request to disable can be among them */
            lose_agent(0);
        }
        epg_xrce_link_drop(&client.link);
        return;
    }
    time_heartbeat();
    exchange_frames();
    bool busy = false;
    if (client.status.state == EPG_XRCE_WAITING) {
        poll_waiting();
    } else if (check_agent()) {
        if (client.target->service_count > 0) {
            epg_xrce_services_poll(&client.services, now_ns); /* the library's buffer is free until the next message */
        }
        busy = client.status.state == EPG_XRCE_CREATING ? poll_creating() : epg_node_poll(client.node, client.now_ns);
    }
    if (client.status.state != EPG_XRCE_WAITING && client.buffered < LONG_MESSAGES) {
        uxr_flash_output_streams(&client.session);
        if (client.now_ns >= client.node->clock.due_ns) { /* after the messages, for which there is room on the line */
            ask_for_time(busy);
        }
    }
}

static void stop(void)
{
    if (client.status.state != EPG_XRCE_WAITING && client.stream->connected(client.stream->context)) {
        uxr_flash_output_streams(&client.session);
        say_goodbye();
    }
    client.now_ns = epg_port_time_ns();
    wait_for_agent(0);
}

epg_xrce_status_t epg_xrce_status(void)
{
    epg_xrce_status_t status = client.status;
    status.dropped = client.guard.dropped + client.link.broken;
    return status;
}

static const char *state(void)
{
    static const char *const names[] = {"waiting", "creating", "running"};
    return names[client.status.state];
}

const epg_middleware_t epg_xrce = {.start = start, .poll = poll, .stop = stop, .state = state, .one_part = true};
