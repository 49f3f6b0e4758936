/**
 * @file
 * A minimal agent.
 */
#include "agent.h"

#include <string.h>

#include "check.h"
#include "fake_port.h"

enum { HEADER = 4, SUBHEADER = 4, SESSION = 0x81, RELIABLE = 0x80, KEY = 4 };
enum {
    CREATE_CLIENT = 0x00,
    CREATE = 0x01,
    GET_INFO = 0x02,
    DELETE = 0x03,
    STATUS_AGENT = 0x04,
    STATUS = 0x05,
    INFO = 0x06,
    WRITE_DATA = 0x07,
    READ_DATA = 0x08,
    DATA = 0x09,
    ACKNACK = 0x0A,
    HEARTBEAT = 0x0B,
    TIMESTAMP = 0x0E,
    TIMESTAMP_REPLY = 0x0F
};

agent_t agent;

void agent_reset(void)
{
    memset(&agent, 0, sizeof agent);
    agent.room = 65507;
    agent.acknowledges = true;
    agent.ahead_ns = UINT64_C(3600000000000);
}

void agent_restart(void)
{
    agent.known = false;
    agent.waiting_count = 0;
}

void agent_say_raw(const void *data, size_t size)
{
    const size_t most = sizeof agent.waiting / sizeof agent.waiting[0];
    CHECK(agent.waiting_count < most && size <= AGENT_FRAME);
    agent_frame_t *frame = &agent.waiting[(agent.waiting_first + agent.waiting_count++) % most];
    frame->time_ns = fake_port.now_ns + agent.there_ns + agent.back_ns;
    frame->size = size;
    memcpy(frame->data, data, size);
}

void agent_say(bool reliable, uint8_t id, const void *payload, size_t size)
{
    unsigned char frame[AGENT_FRAME] = {SESSION, reliable ? RELIABLE : 0};
    if (reliable) {
        frame[2] = (unsigned char)(agent.next & 0xFFU);
        frame[3] = (unsigned char)(agent.next >> 8);
        agent.next++;
    }
    frame[4] = id;
    frame[5] = 1;
    frame[6] = (unsigned char)(size & 0xFFU);
    frame[7] = (unsigned char)(size >> 8);
    memcpy(frame + HEADER + SUBHEADER, payload, size);
    agent_say_raw(frame, HEADER + SUBHEADER + size);
}

void agent_publish(double value)
{
    unsigned char payload[4 + sizeof value] = {agent.request[0], agent.request[1], agent.reader[0], agent.reader[1]};
    memcpy(payload + 4, &value, sizeof value);
    agent_say(true, DATA, payload, sizeof payload);
}

static void acknowledge(void)
{
    const unsigned char payload[5] = {(unsigned char)(agent.expected & 0xFFU), (unsigned char)(agent.expected >> 8), 0,
                                      0, RELIABLE};
    agent_say(false, ACKNACK, payload, sizeof payload);
}

/** Answers the board's heartbeat.  A frame up to `last` that has not arrived is reported as missing. */
static void answer_heartbeat(uint16_t last)
{
    const int missing = (int16_t)(uint16_t)(last + 1U - agent.expected);
    const unsigned int bits = missing > 0 ? (1U << missing) - 1U : 0U;
    const unsigned char payload[5] = {(unsigned char)(agent.expected & 0xFFU), (unsigned char)(agent.expected >> 8),
                                      (unsigned char)(bits >> 8), (unsigned char)(bits & 0xFFU), RELIABLE};
    agent_say(false, ACKNACK, payload, sizeof payload);
}

static void open_session(const unsigned char *payload)
{
    static const unsigned char accepted[11] = {0, 0, 'X', 'R', 'C', 'E', 1, 0, 1, 0x0F, 0};
    agent.known = true;
    agent.sessions++;
    agent.expected = 0;
    agent.next = 0;
    memcpy(&agent.key, payload + 8, sizeof agent.key);
    agent.mtu = (uint16_t)(payload[44] | payload[45] << 8); /* after the property */
    agent_say(false, STATUS_AGENT, accepted, sizeof accepted);
}

static void ping(const unsigned char *payload)
{
    const unsigned char info[22] = {payload[0], payload[1], payload[2], payload[3], 0, agent.known, 1,    0x0D, 'X',
                                    'R',        'C',        'E',        1,          0, 1,           0x0F, 0,    1,
                                    0x0D,       0,          1,          0};
    agent.pings++;
    agent_say(false, INFO, info, sizeof info);
}

static void tell_time(const unsigned char *payload)
{
    unsigned char reply[24];
    const uint64_t now_ns = fake_port.now_ns + agent.there_ns + agent.ahead_ns;
    const uint32_t now[2] = {(uint32_t)(now_ns / 1000000000U), (uint32_t)(now_ns % 1000000000U)};
    if (agent.mute_clock) {
        return;
    }
    memcpy(reply, now, sizeof now);
    memcpy(reply + 8, now, sizeof now);
    memcpy(reply + 16, payload, 8);
    agent_say(false, TIMESTAMP_REPLY, reply, sizeof reply);
}

/** A sample of writer 1 is a number, one of writer 2 begins with a stamp. */
static void take_sample(const unsigned char *payload)
{
    uint32_t stamp[2];
    if (payload[3] >> 4 == 1) {
        memcpy(&agent.values[agent.samples++], payload + 4, sizeof(double));
        return;
    }
    memcpy(stamp, payload + 4, sizeof stamp);
    CHECK(agent.stamp_count < AGENT_FRAMES);
    agent.stamps[agent.stamp_count++] =
        (agent_stamp_t){.time_ns = fake_port.now_ns, .stamp_ns = stamp[0] * UINT64_C(1000000000) + stamp[1]};
}

static void take_submessage(uint8_t id, const unsigned char *payload)
{
    const unsigned char status[6] = {payload[0], payload[1], payload[2], payload[3], agent.status, 0};
    switch (id) {
    case CREATE:
        agent.created += agent.status == 0 ? 1U : 0U;
        agent_say(true, STATUS, status, sizeof status);
        break;
    case READ_DATA:
        agent.readers++;
        memcpy(agent.request, payload, 2);
        memcpy(agent.reader, payload + 2, 2);
        break;
    case WRITE_DATA:
        take_sample(payload);
        break;
    case GET_INFO:
        ping(payload);
        break;
    case TIMESTAMP:
        tell_time(payload);
        break;
    case HEARTBEAT:
        agent.heartbeats++;
        answer_heartbeat((uint16_t)(payload[2] | payload[3] << 8));
        break;
    default:
        break;
    }
}

static void take_submessages(const unsigned char *data, size_t size)
{
    for (size_t at = HEADER; size - at >= SUBHEADER && at < size;) {
        const size_t length = (size_t)(data[at + 2] | data[at + 3] << 8);
        CHECK(length <= size - at - SUBHEADER);
        take_submessage(data[at], data + at + SUBHEADER);
        at += (SUBHEADER + length + 3) / 4 * 4;
        if (at > size) {
            break;
        }
    }
}

static void take_reliable(const unsigned char *data, size_t size)
{
    const uint16_t number = (uint16_t)(data[2] | data[3] << 8);
    if (agent.losing > 0 || agent.loses_every) {
        agent.losing -= agent.losing > 0 ? 1U : 0U;
        return;
    }
    if (number == agent.expected) {
        agent.expected++;
        take_submessages(data, size);
    }
    if (agent.acknowledges) {
        acknowledge();
    }
}

static void take_frame(const unsigned char *data, size_t size)
{
    if (data[0] < 0x80) { /* with the client's key: the board closes the session */
        CHECK(data[HEADER + KEY] == DELETE);
        agent.goodbyes++;
        agent.known = false;
    } else if (data[0] == 0x80) {
        /* The property "uxr_hl" makes the payload 30 bytes longer.  The library gives its length without the property. */
        CHECK(data[HEADER] == CREATE_CLIENT && data[HEADER + 2] == 16 && size == HEADER + SUBHEADER + 16 + 30);
        open_session(data + HEADER + SUBHEADER);
    } else if (!agent.known) {
        if (data[HEADER] == GET_INFO) {
            ping(data + HEADER + SUBHEADER);
        }
    } else if (data[1] == RELIABLE) {
        take_reliable(data, size);
    } else {
        take_submessages(data, size);
    }
}

/* The stream --------------------------------------------------------------------------------------------------- */

static bool stream_connected(void *context)
{
    (void)context;
    return !agent.unplugged;
}

static size_t stream_read(void *context, void *data, size_t size)
{
    (void)context;
    if (agent.busy) {
        return 0;
    }
    for (; agent.unread > 0; agent.unread--) {
        const agent_frame_t *sent = &agent.sent[agent.sent_count - agent.unread];
        take_frame(sent->data, sent->size);
    }
    if (agent.waiting_count == 0) {
        return 0;
    }
    const agent_frame_t *frame = &agent.waiting[agent.waiting_first];
    if (frame->time_ns > fake_port.now_ns) {
        return 0; /* it is still on its way */
    }
    const size_t count = frame->size < size ? frame->size : size;
    memcpy(data, frame->data, count);
    agent.waiting_first = (agent.waiting_first + 1) % (sizeof agent.waiting / sizeof agent.waiting[0]);
    agent.waiting_count--;
    agent.read_count++;
    return count;
}

static size_t stream_write(void *context, const void *data, size_t size)
{
    (void)context;
    CHECK(!agent.unplugged && size <= agent.room && size <= AGENT_FRAME && agent.sent_count < AGENT_FRAMES);
    agent_frame_t *frame = &agent.sent[agent.sent_count++];
    frame->time_ns = fake_port.now_ns;
    frame->size = size;
    memcpy(frame->data, data, size);
    if (agent.busy) {
        agent.unread++;
    } else if (!agent.absent) {
        take_frame(frame->data, size);
    }
    return size;
}

static size_t stream_writable(void *context)
{
    (void)context;
    return agent.unplugged ? 0 : agent.room;
}

const epg_stream_t agent_stream = {.connected = stream_connected,
                                   .read = stream_read,
                                   .write = stream_write,
                                   .writable = stream_writable,
                                   .datagrams = true};

static uint8_t first_submessage(const agent_frame_t *frame)
{
    return frame->data[frame->data[0] < 0x80 ? HEADER + KEY : HEADER];
}

unsigned int agent_count(uint8_t id)
{
    unsigned int count = 0;
    for (size_t i = 0; i < agent.sent_count; i++) {
        count += first_submessage(&agent.sent[i]) == id ? 1U : 0U;
    }
    return count;
}
