/**
 * @file
 * An honest XRCE agent.  Formats: DDS-XRCE 1.0, chapter 8 and annex A.
 */
#include "agent.h"

#include <string.h>

enum {
    SESSION = 0x81,
    RELIABLE = 0x80,
    SERVICES = 0x81,
    BEST_EFFORT = 0x01,
    NO_STREAM = 0x00,
    LITTLE_ENDIAN_FLAG = 0x01
};
enum { LAST_FRAGMENT_FLAG = 0x02, REPLIER = 8, IDENTITY = 24, HEAD = 8 + IDENTITY };
enum {
    CREATE_CLIENT = 0,
    CREATE = 1,
    GET_INFO = 2,
    STATUS_AGENT = 4,
    STATUS = 5,
    INFO = 6,
    WRITE_DATA = 7,
    READ_DATA = 8,
    DATA = 9,
    ACKNACK = 10,
    HEARTBEAT = 11,
    FRAGMENT = 13,
    TIMESTAMP = 14,
    TIMESTAMP_REPLY = 15
};

static uint16_t number_at(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

void agent_queue(agent_t *agent, const uint8_t *frame, size_t size)
{
    if (agent->taken == agent->queued) {
        agent->taken = agent->queued = 0;
    }
    if (agent->queued < AGENT_QUEUE && size <= AGENT_FRAME) {
        agent_frame_t *place = &agent->queue[agent->queued++];
        place->size = size;
        if (size > 0) {
            memcpy(place->bytes, frame, size);
        }
    }
}

agent_frame_t *agent_next(agent_t *agent)
{
    return agent->taken < agent->queued ? &agent->queue[agent->taken++] : NULL;
}

static agent_stream_t *stream_of(agent_t *agent, uint8_t number)
{
    return number == RELIABLE ? &agent->topics : number == SERVICES ? &agent->services : NULL;
}

/** Sends one submessage on `stream`. */
static void send(agent_t *agent, uint8_t stream, uint8_t id, uint8_t flags, const uint8_t *payload, size_t size)
{
    uint8_t frame[AGENT_FRAME] = {SESSION, stream, 0, 0, id, flags, (uint8_t)size, (uint8_t)(size >> 8)};
    agent_stream_t *reliable = stream_of(agent, stream);
    uint16_t *next = reliable != NULL ? &reliable->next : &agent->best_effort;
    if (stream != NO_STREAM) {
        frame[2] = (uint8_t)*next;
        frame[3] = (uint8_t)(*next >> 8);
    }
    memcpy(frame + 8, payload, size);
    if (reliable != NULL) {
        agent_frame_t *kept = &reliable->sent[*next % AGENT_WINDOW];
        kept->size = 8 + size;
        memcpy(kept->bytes, frame, 8 + size);
    }
    if (stream != NO_STREAM) {
        (*next)++;
    }
    agent_queue(agent, frame, 8 + size);
}

static void reply(agent_t *agent, uint8_t stream, uint8_t id, const uint8_t *payload, size_t size)
{
    send(agent, stream, id, LITTLE_ENDIAN_FLAG, payload, size);
}

void agent_forget(agent_t *agent)
{
    memset(agent->requests, 0, sizeof agent->requests);
    agent->session = false;
    agent->topics.expected = agent->topics.next = agent->topics.unacknowledged = agent->best_effort = 0;
    agent->services.expected = agent->services.next = agent->services.unacknowledged = 0;
    agent->readers = agent->replier_count = agent->message_size = 0;
}

static void create_client(agent_t *agent)
{
    static const uint8_t granted[11] = {0, 0, 'X', 'R', 'C', 'E', 1, 0, 1, 15, 0};
    agent_forget(agent);
    agent->session = true;
    reply(agent, NO_STREAM, STATUS_AGENT, granted, sizeof granted);
}

static void send_acknack(agent_t *agent, uint8_t stream, uint16_t missing)
{
    const uint16_t expected = stream_of(agent, stream)->expected;
    const uint8_t payload[5] = {(uint8_t)expected, (uint8_t)(expected >> 8), (uint8_t)(missing >> 8), (uint8_t)missing,
                                stream};
    reply(agent, NO_STREAM, ACKNACK, payload, sizeof payload);
}

static void answer_ping(agent_t *agent, const uint8_t *request)
{
    uint8_t payload[28] = {0, 0, 0, 0, 0, 1, 1, 0x0D, 'X', 'R', 'C', 'E', 1, 0, 1, 15, 0, 1, 0x0D, 0, 1};
    memcpy(payload, request, 4);
    reply(agent, NO_STREAM, INFO, payload, sizeof payload);
}

static void take_acknack(agent_t *agent, agent_stream_t *stream, const uint8_t *payload)
{
    const uint16_t first = number_at(payload);
    const unsigned int missing = (unsigned int)(payload[2] << 8 | payload[3]);
    if ((uint16_t)(first - stream->unacknowledged) <= (uint16_t)(stream->next - stream->unacknowledged)) {
        stream->unacknowledged = first;
    }
    for (unsigned int i = 0; i < AGENT_WINDOW; i++) {
        const uint16_t number = (uint16_t)(first + i);
        if ((missing >> i & 1U) != 0 &&
            (uint16_t)(number - stream->unacknowledged) < (uint16_t)(stream->next - stream->unacknowledged)) {
            const agent_frame_t *kept = &stream->sent[number % AGENT_WINDOW];
            agent_queue(agent, kept->bytes, kept->size);
        }
    }
}

/** Takes a WRITE_DATA: a sample of a topic, or a reply. */
static void take_written(agent_t *agent, const uint8_t *payload, size_t size)
{
    if (size >= 4 + IDENTITY && (payload[3] & 0x0F) == REPLIER) {
        agent->replies++;
        memcpy(&agent->last_request, payload + 4, sizeof agent->last_request);
        agent->last_reply_size = size - 4 - IDENTITY;
        memcpy(agent->last_reply, payload + 4 + IDENTITY, agent->last_reply_size);
    } else {
        agent->written++;
    }
}

static void take_fragment(agent_t *agent, uint8_t flags, const uint8_t *payload, size_t size)
{
    const size_t room = AGENT_MESSAGE - agent->message_size;
    const size_t taken = size < room ? size : room;
    memcpy(agent->message + agent->message_size, payload, taken);
    agent->message_size += taken;
    if ((flags & LAST_FRAGMENT_FLAG) != 0) {
        if (agent->message_size >= HEAD && agent->message[0] == WRITE_DATA) {
            take_written(agent, agent->message + 4, agent->message_size - 4);
        }
        agent->message_size = 0;
    }
}

static void take_submessage(agent_t *agent, uint8_t id, uint8_t flags, const uint8_t *payload, size_t size)
{
    if (id == GET_INFO && size >= 4) {
        answer_ping(agent, payload);
    } else if (id == CREATE && size >= 4) {
        uint8_t granted[6] = {0};
        memcpy(granted, payload, 4);
        reply(agent, RELIABLE, STATUS, granted, sizeof granted);
    } else if (id == READ_DATA && size >= 6 && (payload[3] & 0x0F) == REPLIER && agent->replier_count < AGENT_READERS) {
        memcpy(agent->repliers[agent->replier_count++], payload, 4);
    } else if (id == READ_DATA && size >= 6 && agent->readers < AGENT_READERS) {
        memcpy(agent->requests[agent->readers], payload, 4);
        agent->streams[agent->readers++] = payload[4];
    } else if (id == WRITE_DATA) {
        take_written(agent, payload, size);
    } else if (id == FRAGMENT) {
        take_fragment(agent, flags, payload, size);
    } else if (id == ACKNACK && size >= 5 && stream_of(agent, payload[4]) != NULL) {
        take_acknack(agent, stream_of(agent, payload[4]), payload);
    } else if (id == HEARTBEAT && size >= 5 && stream_of(agent, payload[4]) != NULL) {
        const uint16_t count = (uint16_t)(number_at(payload + 2) + 1 - stream_of(agent, payload[4])->expected);
        send_acknack(agent, payload[4], (uint16_t)(count > AGENT_WINDOW ? 0U : (1U << count) - 1U));
    } else if (id == TIMESTAMP && size >= 8) {
        uint8_t times[24] = {0, 0, 0, 60, 0, 0, 0, 0, 0, 0, 0, 60};
        memcpy(times + 16, payload, 8);
        reply(agent, NO_STREAM, TIMESTAMP_REPLY, times, sizeof times);
    }
}

static void take_submessages(agent_t *agent, const uint8_t *body, size_t size)
{
    for (size_t at = 0; at + 4 <= size;) {
        const size_t length = number_at(body + at + 2);
        if (length > size - at - 4) {
            return;
        }
        take_submessage(agent, body[at], body[at + 1], body + at + 4, length);
        at = (at + 4 + length + 3) & ~(size_t)3;
    }
}

void agent_receive(agent_t *agent, const uint8_t *frame, size_t size)
{
    if (size >= 8 && frame[0] == 0x80 && frame[4] == CREATE_CLIENT) {
        create_client(agent);
    } else if (size >= 4 && frame[0] == SESSION && agent->session) {
        agent_stream_t *stream = stream_of(agent, frame[1]);
        if (stream == NULL) {
            take_submessages(agent, frame + 4, size - 4);
            return;
        }
        const unsigned int ahead = (uint16_t)(number_at(frame + 2) - stream->expected);
        if (ahead == 0) {
            stream->expected++;
            take_submessages(agent, frame + 4, size - 4);
        }
        /* the frames between were lost */
        send_acknack(agent, frame[1], (uint16_t)(ahead == 0 || ahead >= AGENT_WINDOW ? 0U : (1U << (ahead + 1U)) - 1U));
    }
}

void agent_sample(agent_t *agent, size_t reader, const uint8_t *data, size_t size)
{
    uint8_t payload[AGENT_FRAME - 8];
    if (reader < agent->readers && size + 4 <= sizeof payload &&
        (uint16_t)(agent->topics.next - agent->topics.unacknowledged) < AGENT_WINDOW - 1) {
        memcpy(payload, agent->requests[reader], 4);
        if (size > 0) {
            memcpy(payload + 4, data, size);
        }
        reply(agent, agent->streams[reader], DATA, payload, 4 + size);
    }
}

bool agent_request(agent_t *agent, size_t service, uint32_t number, const uint8_t *data, size_t size)
{
    enum { SHARE = AGENT_MTU - 8 };
    uint8_t message[HEAD + AGENT_MESSAGE] = {DATA, LITTLE_ENDIAN_FLAG, (uint8_t)(HEAD - 4 + size),
                                             (uint8_t)((HEAD - 4 + size) >> 8)};
    const size_t length = HEAD + size;
    const size_t frames = 4 + length <= AGENT_MTU ? 1 : (length + SHARE - 1) / SHARE;
    if (service >= agent->replier_count || size > AGENT_MESSAGE ||
        (uint16_t)(agent->services.next - agent->services.unacknowledged) + frames >= AGENT_WINDOW) {
        return false;
    }
    memcpy(message + 4, agent->repliers[service], 4);
    memcpy(message + 8, &number, sizeof number);
    if (size > 0) {
        memcpy(message + HEAD, data, size);
    }
    if (frames == 1) {
        reply(agent, SERVICES, DATA, message + 4, length - 4);
        return true;
    }
    for (size_t at = 0; at < length; at += SHARE) {
        const size_t left = length - at;
        const uint8_t flags = LITTLE_ENDIAN_FLAG | (left <= SHARE ? LAST_FRAGMENT_FLAG : 0);
        send(agent, SERVICES, FRAGMENT, flags, message + at, left < SHARE ? left : SHARE);
    }
    return true;
}

static void beat(agent_t *agent, uint8_t number)
{
    const agent_stream_t *stream = stream_of(agent, number);
    const uint16_t last = (uint16_t)(stream->next - 1U);
    const uint8_t payload[5] = {(uint8_t)stream->unacknowledged, (uint8_t)(stream->unacknowledged >> 8), (uint8_t)last,
                                (uint8_t)(last >> 8), number};
    if (agent->session && stream->next != stream->unacknowledged) {
        reply(agent, NO_STREAM, HEARTBEAT, payload, sizeof payload);
    }
}

void agent_beat(agent_t *agent)
{
    beat(agent, RELIABLE);
    beat(agent, SERVICES);
}
