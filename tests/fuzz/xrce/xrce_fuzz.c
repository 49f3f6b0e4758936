/**
 * @file
 * Hostile bytes for a board with the middleware `xrce`.
 *
 * An input begins with the connection of the board and its progress (waiting, creating, running).  A list of events
 * follows: bytes, frames and samples of a stranger, damaged answers of an honest agent, time, an unplugged line, a line
 * without space.  Then only the honest agent remains.  Within ten seconds the board must be running and a setpoint must
 * reach the model, whatever has happened before.  Sanitizers check the whole run.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "agent.h"
#include "epg/diagnostics.h"
#include "epg/node.h"
#include "epg/service.h"
#include "fake_application.h"
#include "fake_port.h"
#include "reply.h"
#include "xrce.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MTU = 512, HISTORY = 4, LINE = 16384, RECOVERY_MS = 10000, STEP_MS = 10, MONITORED = 3 };
enum { REQUEST = 2000, REPEATED = 4 };
enum { BEGIN = 0x7E, ESCAPE = 0x7D, XOR = 0x20 };

#define MS ((uint64_t)1000000)

/* The line --------------------------------------------------------------------------------------------------------- */

static struct {
    bool datagrams;
    bool connected;
    size_t room;
    uint8_t in[LINE]; /* bytes for the board */
    size_t in_size;
    size_t in_taken;
    uint8_t out[LINE]; /* bytes of a frame of the board */
    size_t out_size;
    bool out_escaped;
    uint8_t damage_at;
    unsigned int since_beat; /* ms */
    uint8_t damage;          /* XOR mask for one byte of the agent's next frame; 0: none */
} line;

static agent_t agent;

static bool is_connected(void *context)
{
    (void)context;
    return line.connected;
}

static uint16_t crc_of(const uint8_t *data, size_t size)
{
    unsigned int crc = 0;
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1U) != 0 ? crc >> 1 ^ 0xA001U : crc >> 1;
        }
    }
    return (uint16_t)crc;
}

static void put_in(uint8_t byte)
{
    if (line.in_size < LINE) {
        line.in[line.in_size++] = byte;
    }
}

static void put_stuffed(uint8_t byte)
{
    if (byte == BEGIN || byte == ESCAPE) {
        put_in(ESCAPE);
        byte ^= XOR;
    }
    put_in(byte);
}

static void put_frame(const uint8_t *data, size_t size)
{
    const uint16_t crc = crc_of(data, size);
    put_in(BEGIN);
    put_stuffed(0);
    put_stuffed(1);
    put_stuffed((uint8_t)size);
    put_stuffed((uint8_t)(size >> 8));
    for (size_t i = 0; i < size; i++) {
        put_stuffed(data[i]);
    }
    put_stuffed((uint8_t)crc);
    put_stuffed((uint8_t)(crc >> 8));
}

/** The agent's next frame, or NULL. */
static agent_frame_t *next_frame(void)
{
    agent_frame_t *frame = agent_next(&agent);
    if (frame != NULL && frame->size > 0 && line.damage != 0) {
        frame->bytes[line.damage_at % frame->size] ^= line.damage;
        line.damage = 0;
    }
    return frame;
}

static size_t read_line(void *context, void *data, size_t size)
{
    (void)context;
    if (line.datagrams) {
        const agent_frame_t *frame = next_frame();
        const size_t count = frame == NULL ? 0 : frame->size < size ? frame->size : size;
        if (count > 0) {
            memcpy(data, frame->bytes, count);
        }
        return count;
    }
    if (line.in_taken == line.in_size) {
        line.in_taken = line.in_size = 0;
        const agent_frame_t *frame = next_frame();
        if (frame != NULL) {
            put_frame(frame->bytes, frame->size);
        }
    }
    const size_t left = line.in_size - line.in_taken;
    const size_t count = left < size ? left : size;
    memcpy(data, line.in + line.in_taken, count);
    line.in_taken += count;
    return count;
}

/** Removes the byte stuffing of the board's frames. */
static void take_out(uint8_t byte)
{
    if (byte == BEGIN) {
        line.out_size = 0;
        line.out_escaped = false;
        return;
    }
    if (byte == ESCAPE) {
        line.out_escaped = true;
        return;
    }
    if (line.out_size < LINE) {
        line.out[line.out_size++] = line.out_escaped ? byte ^ XOR : byte;
    }
    line.out_escaped = false;
    if (line.out_size >= 4 && line.out_size == 6U + line.out[2] + 256U * line.out[3]) {
        agent_receive(&agent, line.out + 4, line.out_size - 6);
        line.out_size = 0;
    }
}

static size_t write_line(void *context, const void *data, size_t size)
{
    (void)context;
    const uint8_t *bytes = data;
    if (size > line.room) {
        abort(); /* the board asks for the free space first */
    }
    line.room -= size;
    if (line.datagrams) {
        agent_receive(&agent, bytes, size);
    } else {
        for (size_t i = 0; i < size; i++) {
            take_out(bytes[i]);
        }
    }
    return size;
}

static size_t room(void *context)
{
    (void)context;
    return line.room;
}

/* The board -------------------------------------------------------------------------------------------------------- */

static const char *const joints[1] = {"pan"};
static const uint8_t joint_fields[2] = {0, 1};
static const epg_message_layout_t joint_layout = {.fields = joint_fields, .count = 1, .names = joints, .frame_id = ""};
static const epg_topic_t subscriptions[] = {
    {.name = "set_a", .message = &epg_message_float64, .size = 8, .qos = EPG_QOS_RELIABLE, .depth = 10, .count = 1},
    {.name = "/set_b",
     .message = &epg_message_float32,
     .size = 4,
     .qos = EPG_QOS_BEST_EFFORT,
     .depth = 10,
     .index = 1,
     .count = 1},
    {.name = "~/enable",
     .message = &epg_message_bool,
     .size = 1,
     .qos = EPG_QOS_RELIABLE,
     .depth = 10,
     .role = EPG_TOPIC_ENABLE,
     .count = 1},
    {.name = "joints",
     .message = &epg_message_joint_state,
     .layout = &joint_layout,
     .qos = EPG_QOS_BEST_EFFORT,
     .depth = 10,
     .size = 400,
     .count = 2},
    {.name = "ping",
     .message = &epg_message_float64,
     .size = 8,
     .qos = EPG_QOS_BEST_EFFORT,
     .depth = 10,
     .role = EPG_TOPIC_ECHO,
     .index = 3},
};
static const epg_topic_t publications[] = {
    {.name = "angle",
     .message = &epg_message_float64,
     .size = 8,
     .qos = EPG_QOS_RELIABLE,
     .depth = 10,
     .count = 1,
     .period_ns = 33 * MS},
    {.name = "count",
     .message = &epg_message_int32,
     .size = 4,
     .qos = EPG_QOS_BEST_EFFORT,
     .depth = 10,
     .count = 1,
     .trigger = EPG_TOPIC_CHANGE},
    {.name = "/diagnostics",
     .message = &epg_message_diagnostic_array,
     .size = 1400,
     .qos = EPG_QOS_RELIABLE,
     .depth = 10,
     .role = EPG_TOPIC_DIAGNOSTICS,
     .period_ns = 1000 * MS},
    {.name = "pong",
     .message = &epg_message_float64,
     .size = 8,
     .qos = EPG_QOS_BEST_EFFORT,
     .depth = 10,
     .role = EPG_TOPIC_ECHO},
};

enum { SUBSCRIPTIONS = sizeof subscriptions / sizeof subscriptions[0] };
enum { PUBLICATIONS = sizeof publications / sizeof publications[0] };
enum { BUFFER = 1400, OUTPUT = BUFFER + EPG_XRCE_OVERHEAD };

/* The service "copy" answers with its request, REPEATED times. */

static bool take_copy(epg_node_t *node, epg_cdr_reader_t *request)
{
    (void)node;
    return request->size > 0 && request->data[0] != 0xFF;
}

static bool write_copy(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    const epg_service_state_t *state = node->target->service_state;
    for (size_t i = 0; part < REPEATED && i < state->length; i++) {
        epg_reply_u8(reply, state->request[i]);
    }
    return part < REPEATED;
}

static const epg_service_kind_t copy = {
    .request = {.type = "copy_Request_", .hash = "RIHS01_0"},
    .reply = {.type = "copy_Response_", .hash = "RIHS01_1"},
    .take = take_copy,
    .write = write_copy,
};
static const epg_service_t services[] = {
    {.name = "~/enable", .kind = &epg_service_enable, .request_size = 8},
    {.name = "~/copy", .kind = &copy, .request_size = REQUEST},
};
static unsigned char service_request[REQUEST];
static epg_service_state_t service_state = {.request = service_request, .request_size = sizeof service_request};

static double values[MONITORED], sent_values[MONITORED], received_values[2];
static epg_node_publication_t states[PUBLICATIONS];
static unsigned char buffer[BUFFER];
static epg_node_t node;
static double monitor_values[MONITORED], monitor_buffers[4][MONITORED];
static epg_exchange_t monitor_exchange = EPG_EXCHANGE(monitor_buffers);
static uint8_t frame_in[MTU], history_in[EPG_XRCE_HISTORY_SIZE(HISTORY, MTU)];
static uint8_t frame_out[OUTPUT], history_out[EPG_XRCE_HISTORY_SIZE(HISTORY, OUTPUT)];
static const epg_xrce_options_t options = {
    .history = HISTORY,
    .input_frame = MTU,
    .output_frame = OUTPUT,
    .received = frame_in,
    .input = history_in,
    .output = history_out,
    .best_effort = frame_out,
};
static const char *const components[6] = {"a", "b", "c", "d", "e", "f"};
static epg_target_t target = {
    .control = &fake.control,
    .node = "fuzz_$serial",
    .name_space = "/robots",
    .domain = EPG_DOMAIN_DEFAULT,
    .communication_period_ns = 33 * MS,
    .component_count = 6,
    .components = components,
    .subscription_count = SUBSCRIPTIONS,
    .subscriptions = subscriptions,
    .publication_count = PUBLICATIONS,
    .publications = publications,
    .service_count = sizeof services / sizeof services[0],
    .services = services,
    .service_state = &service_state,
    .version = "1",
    .hash = "0123456789abcdef",
    .options = &options,
    .node_state = &node,
    .time_index = MONITORED - 1,
};
static epg_stream_t stream = {
    .connected = is_connected,
    .read = read_line,
    .write = write_line,
    .writable = room,
};

static void monitor(double *monitored)
{
    monitored[0] = fake.output;
    monitored[1] = fake.input;
    memcpy(&monitored[MONITORED - 1], &fake.control.time_ns, sizeof fake.control.time_ns);
}

static void start(bool datagrams)
{
    fake_reset();
    fake.application.monitor = monitor;
    fake.application.monitor_count = MONITORED;
    fake.application.monitor_values = monitor_values;
    fake.application.monitor_exchange = &monitor_exchange;
    line.in_size = line.in_taken = line.out_size = 0;
    line.damage = 0;
    line.since_beat = 0;
    agent_forget(&agent);
    agent.queued = agent.taken = agent.written = agent.replies = agent.last_request = 0;
    service_state.service = NULL;
    line.datagrams = datagrams;
    line.connected = true;
    line.room = LINE;
    stream.datagrams = datagrams;
    node = (epg_node_t){.values = values,
                        .sent_values = sent_values,
                        .received = received_values,
                        .publications = states,
                        .buffer = buffer,
                        .buffer_size = sizeof buffer};
    target.application = &fake.application;
    target.middleware = &epg_xrce;
    fake_start();
    epg_xrce.start(&target, &stream);
}

/** Runs a cycle and a poll, `milliseconds` after the last ones. */
static void step(unsigned int milliseconds)
{
    fake_port.now_ns += (milliseconds - 1) * MS;
    fake.tick = fake_port.now_ns / FAKE_PERIOD_NS;
    fake_cycle();
    epg_xrce.poll(fake_port.now_ns);
    line.since_beat += milliseconds;
    if (line.since_beat >= 200) {
        line.since_beat = 0;
        agent_beat(&agent);
    }
}

static epg_xrce_state_t state(void)
{
    return epg_xrce_status().state;
}

/* Events ----------------------------------------------------------------------------------------------------------- */

typedef struct input {
    const uint8_t *data;
    size_t size;
} input_t;

static uint8_t take(input_t *input)
{
    if (input->size == 0) {
        return 0;
    }
    input->size--;
    return *input->data++;
}

/** Takes up to `most` bytes; the next byte of the input sets the number. */
static size_t take_some(input_t *input, const uint8_t **bytes, size_t most)
{
    const size_t wanted = (size_t)take(input) * 2 % (most + 1);
    const size_t size = wanted < input->size ? wanted : input->size;
    *bytes = input->data;
    input->data += size;
    input->size -= size;
    return size;
}

/** Sends a frame on a stream with arbitrary submessages; `ahead`: distance to the number that the board expects. */
static void strange_frame(input_t *input, uint8_t which, int ahead)
{
    static const uint8_t ids[4] = {0x00, 0x01, 0x80, 0x81};
    uint8_t frame[AGENT_FRAME] = {0x81, ids[which]};
    const uint8_t *bytes;
    const uint16_t expected = which == 2 ? agent.topics.next : which == 3 ? agent.services.next : agent.best_effort;
    const uint16_t number = (uint16_t)(expected + ahead);
    frame[2] = (uint8_t)number;
    frame[3] = (uint8_t)(number >> 8);
    const size_t size = take_some(input, &bytes, 508);
    if (size > 0) {
        memcpy(frame + 4, bytes, size);
    }
    agent_queue(&agent, frame, 4 + size);
}

/** Sends a submessage with the correct length. */
static void strange_submessage(input_t *input, uint8_t which, int ahead)
{
    static const uint8_t ids[4] = {0x00, 0x01, 0x80, 0x81};
    uint8_t frame[AGENT_FRAME] = {0x81, ids[which]};
    const uint8_t *bytes;
    const uint16_t number = (uint16_t)((which == 2   ? agent.topics.next
                                        : which == 3 ? agent.services.next
                                                     : agent.best_effort) +
                                       ahead);
    frame[2] = (uint8_t)number;
    frame[3] = (uint8_t)(number >> 8);
    frame[4] = take(input) & 0x0F;
    frame[5] = take(input);
    const size_t size = take_some(input, &bytes, 504);
    frame[6] = (uint8_t)size;
    frame[7] = (uint8_t)(size >> 8);
    if (size > 0) {
        memcpy(frame + 8, bytes, size);
    }
    agent_queue(&agent, frame, 8 + size);
}

static void raw_bytes(input_t *input)
{
    const uint8_t *bytes;
    const size_t size = take_some(input, &bytes, 510);
    if (line.datagrams) {
        agent_queue(&agent, bytes, size);
    } else {
        for (size_t i = 0; i < size; i++) {
            put_in(bytes[i]);
        }
    }
}

/** Sends a request to the first or the second service: the bytes, or for `how` >= 2 many of them. */
static void request(unsigned int how, const uint8_t *bytes, size_t size)
{
    static uint8_t many[2 * REQUEST];
    const size_t most = sizeof many;
    size_t length = how < 2 || size == 0 ? size : size * 16 < most ? size * 16 : most;
    for (size_t i = 0; i < length; i++) {
        many[i] = bytes[i % size];
    }
    (void)agent_request(&agent, how & 1, 1000, many, length);
}

static void happen(input_t *input)
{
    const uint8_t event = take(input);
    const int ahead = (event >> 5) - 3;
    const uint8_t *bytes;
    size_t size;
    switch (event & 7) {
    case 0:
        raw_bytes(input);
        break;
    case 1:
        strange_frame(input, event >> 3 & 3, ahead);
        break;
    case 2:
        strange_submessage(input, event >> 3 & 3, ahead);
        break;
    case 3:
        size = take_some(input, &bytes, 480);
        if ((event & 0xC0) == 0xC0) {
            request(event >> 3 & 3, bytes, size);
        } else {
            agent_sample(&agent, (size_t)(event >> 3) % 8, bytes, size);
        }
        break;
    case 4:
        line.damage_at = take(input);
        line.damage = take(input);
        break;
    case 5:
        for (unsigned int i = 0; i < 4; i++) {
            step(1U + (event >> 3) * 8U);
        }
        break;
    case 6:
        line.connected = (event & 0x08) != 0;
        break;
    default:
        line.room = (size_t)take(input) * 8;
        break;
    }
    step(1);
}

static void check(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "%s\n", what);
        abort();
    }
}

/**
 * A request of many fragments has its reply.  It is sent again every second: a frame of a stranger can have taken the
 * number of one of its frames.
 */
static void ask_for_copy(void)
{
    enum { NUMBER = 7, SIZE = REQUEST - 1 };
    static uint8_t data[SIZE];
    for (size_t i = 0; i < SIZE; i++) {
        data[i] = (uint8_t)(i * 31 >> 3 & 0x7F);
    }
    unsigned int again = 0;
    for (unsigned int i = 0; i < RECOVERY_MS / STEP_MS && agent.last_request != NUMBER; i++) {
        line.room = LINE;
        if (i >= again && agent_request(&agent, 1, NUMBER, data, SIZE)) {
            again = i + 1000 / STEP_MS;
        }
        step(STEP_MS);
    }
    check(agent.last_request == NUMBER && agent.last_reply_size == REPEATED * SIZE, "no reply");
    for (size_t i = 0; i < REPEATED; i++) {
        check(memcmp(agent.last_reply + i * SIZE, data, SIZE) == 0, "a wrong reply");
    }
}

/** Only the honest agent: the board connects again, and a setpoint reaches the model. */
static void recover(void)
{
    static const uint8_t level[2] = {0, 1}, half[8] = {0, 0, 0, 0, 0, 0, 0xE0, 0x3F};
    unsigned int running = 0;
    line.connected = true;
    line.damage = 0;
    bool works = false;
    for (unsigned int i = 0; i < RECOVERY_MS / STEP_MS && !works; i++) {
        line.room = LINE;
        step(STEP_MS);
        if (state() == EPG_XRCE_RUNNING && i % 10 == 0) {
            agent_sample(&agent, 0, half, sizeof half);
        }
        /* An edge, more than a second after the connection and after the last `true`. */
        running = state() == EPG_XRCE_RUNNING ? running + 1 : 0;
        if (running % 150 >= 148) {
            agent_sample(&agent, 2, &level[running % 150 - 148], 1);
        }
        works = state() == EPG_XRCE_RUNNING && fake.control.enabled && epg_control_setpoint(&fake.control, 0) == 0.5;
    }
    check(state() == EPG_XRCE_RUNNING, "not running again");
    ask_for_copy();
    check(works, "no setpoint arrives");
    check(fake_status().fault == EPG_FAULT_NONE, "a fault");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input_t input = {data, size};
    const uint8_t how = take(&input);
    start((how & 1) != 0);
    if ((how & 6) == 2) { /* while the board creates its entities */
        for (unsigned int i = 0; i < 2U + (how >> 4); i++) {
            step(1);
        }
    } else if ((how & 6) != 0) { /* while the board is running */
        for (unsigned int i = 0; i < 200 && state() != EPG_XRCE_RUNNING; i++) {
            step(1);
        }
        check(state() == EPG_XRCE_RUNNING, "it does not start");
    }
    while (input.size > 0) {
        happen(&input);
    }
    if ((how & 8) == 0) {
        recover();
    }
    return 0;
}
