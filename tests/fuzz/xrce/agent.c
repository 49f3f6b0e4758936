/**
 * @file
 * An honest XRCE agent.  Formats: DDS-XRCE 1.0, chapter 8 and annex A.
 */
#include "agent.h"

#include <string.h>

enum { SESSION = 0x81, RELIABLE = 0x80, BEST_EFFORT = 0x01, NO_STREAM = 0x00, LITTLE_ENDIAN_FLAG = 0x01 };
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

/** Sends one submessage on `stream`. */
static void reply(agent_t *agent, uint8_t stream, uint8_t id, const uint8_t *payload, size_t size)
{
    uint8_t frame[AGENT_FRAME] = {SESSION, stream, 0, 0, id, LITTLE_ENDIAN_FLAG, (uint8_t)size, (uint8_t)(size >> 8)};
    uint16_t *next = stream == RELIABLE ? &agent->next : &agent->best_effort;
    if (stream != NO_STREAM) {
        frame[2] = (uint8_t)*next;
        frame[3] = (uint8_t)(*next >> 8);
    }
    memcpy(frame + 8, payload, size);
    if (stream == RELIABLE) {
        agent_frame_t *kept = &agent->sent[agent->next % AGENT_WINDOW];
        kept->size = 8 + size;
        memcpy(kept->bytes, frame, 8 + size);
    }
    if (stream != NO_STREAM) {
        (*next)++;
    }
    agent_queue(agent, frame, 8 + size);
}

static void create_client(agent_t *agent)
{
    static const uint8_t granted[11] = {0, 0, 'X', 'R', 'C', 'E', 1, 0, 1, 15, 0};
    memset(agent->requests, 0, sizeof agent->requests);
    agent->session = true;
    agent->expected = agent->next = agent->unacknowledged = agent->best_effort = 0;
    agent->readers = 0;
    reply(agent, NO_STREAM, STATUS_AGENT, granted, sizeof granted);
}

static void send_acknack(agent_t *agent, uint16_t missing)
{
    const uint8_t payload[5] = {(uint8_t)agent->expected, (uint8_t)(agent->expected >> 8), (uint8_t)(missing >> 8),
                                (uint8_t)missing, RELIABLE};
    reply(agent, NO_STREAM, ACKNACK, payload, sizeof payload);
}

static void answer_ping(agent_t *agent, const uint8_t *request)
{
    uint8_t payload[28] = {0, 0, 0, 0, 0, 1, 1, 0x0D, 'X', 'R', 'C', 'E', 1, 0, 1, 15, 0, 1, 0x0D, 0, 1};
    memcpy(payload, request, 4);
    reply(agent, NO_STREAM, INFO, payload, sizeof payload);
}

static void take_acknack(agent_t *agent, const uint8_t *payload)
{
    const uint16_t first = number_at(payload);
    const unsigned int missing = (unsigned int)(payload[2] << 8 | payload[3]);
    if ((uint16_t)(first - agent->unacknowledged) <= (uint16_t)(agent->next - agent->unacknowledged)) {
        agent->unacknowledged = first;
    }
    for (unsigned int i = 0; i < AGENT_WINDOW; i++) {
        const uint16_t number = (uint16_t)(first + i);
        if ((missing >> i & 1U) != 0 &&
            (uint16_t)(number - agent->unacknowledged) < (uint16_t)(agent->next - agent->unacknowledged)) {
            const agent_frame_t *kept = &agent->sent[number % AGENT_WINDOW];
            agent_queue(agent, kept->bytes, kept->size);
        }
    }
}

static void take_submessage(agent_t *agent, uint8_t id, const uint8_t *payload, size_t size)
{
    if (id == GET_INFO && size >= 4) {
        answer_ping(agent, payload);
    } else if (id == CREATE && size >= 4) {
        uint8_t granted[6] = {0};
        memcpy(granted, payload, 4);
        reply(agent, RELIABLE, STATUS, granted, sizeof granted);
    } else if (id == READ_DATA && size >= 6 && agent->readers < AGENT_READERS) {
        memcpy(agent->requests[agent->readers], payload, 4);
        agent->streams[agent->readers++] = payload[4];
    } else if (id == WRITE_DATA) {
        agent->written++;
    } else if (id == ACKNACK && size >= 5) {
        take_acknack(agent, payload);
    } else if (id == HEARTBEAT && size >= 5) {
        const uint16_t count = (uint16_t)(number_at(payload + 2) + 1 - agent->expected);
        send_acknack(agent, (uint16_t)(count > AGENT_WINDOW ? 0U : (1U << count) - 1U));
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
        take_submessage(agent, body[at], body + at + 4, length);
        at = (at + 4 + length + 3) & ~(size_t)3;
    }
}

void agent_receive(agent_t *agent, const uint8_t *frame, size_t size)
{
    if (size >= 8 && frame[0] == 0x80 && frame[4] == CREATE_CLIENT) {
        create_client(agent);
    } else if (size >= 4 && frame[0] == SESSION && agent->session) {
        const uint16_t number = number_at(frame + 2);
        const bool reliable = frame[1] == RELIABLE;
        const unsigned int ahead = (uint16_t)(number - agent->expected);
        if (!reliable || ahead == 0) {
            agent->expected = (uint16_t)(agent->expected + (reliable ? 1U : 0U));
            take_submessages(agent, frame + 4, size - 4);
        }
        if (reliable) { /* the frames between were lost */
            send_acknack(agent, (uint16_t)(ahead == 0 || ahead >= AGENT_WINDOW ? 0U : (1U << (ahead + 1U)) - 1U));
        }
    }
}

void agent_sample(agent_t *agent, size_t reader, const uint8_t *data, size_t size)
{
    uint8_t payload[AGENT_FRAME - 8];
    if (reader < agent->readers && size + 4 <= sizeof payload &&
        (uint16_t)(agent->next - agent->unacknowledged) < AGENT_WINDOW - 1) {
        memcpy(payload, agent->requests[reader], 4);
        if (size > 0) {
            memcpy(payload + 4, data, size);
        }
        reply(agent, agent->streams[reader], DATA, payload, 4 + size);
    }
}

void agent_beat(agent_t *agent)
{
    if (agent->session && agent->next != agent->unacknowledged) {
        const uint16_t last = (uint16_t)(agent->next - 1U);
        const uint8_t payload[5] = {(uint8_t)agent->unacknowledged, (uint8_t)(agent->unacknowledged >> 8),
                                    (uint8_t)last, (uint8_t)(last >> 8), RELIABLE};
        reply(agent, NO_STREAM, HEARTBEAT, payload, sizeof payload);
    }
}
