/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The guard: checks each received frame before the client library gets it.
 *
 * Source: OMG, "DDS for Extremely Resource Constrained Environments" 1.0, 8.3 (messages) and annex A (payloads).
 */
#include "xrce_guard.h"

#include <string.h>

enum {
    HEADER = 4, /* bytes of a frame's header: session, stream, sequence number */
    SUBHEADER = 4,
    NO_STREAM = 0x00,
    BEST_EFFORT = 0x01, /* this and the next one are the only streams of this session */
    RELIABLE = 0x80,
    LARGEST_HISTORY = 16, /* number of frames that an ACKNACK can name */
    OLDEST = 4096,        /* older numbers do not belong to this session; the library would take them for new ones */
    MOST_BEHIND = 10,     /* heartbeats in a row that end before the handled frames: one can be late, ten cannot */
    PING_REQUEST = GET_INFO_REQUEST_PING_ID,
};

enum {
    STATUS_AGENT = 0x04,
    STATUS = 0x05,
    INFO = 0x06,
    DATA = 0x09,
    ACKNACK = 0x0A,
    HEARTBEAT = 0x0B,
    TIMESTAMP_REPLY = 0x0F,
    NOTHING = 0xFF /* an id that the protocol does not use */
};

enum { LITTLE_ENDIAN_FLAG = 0x01, FORMAT_FLAGS = 0x0E };

static uint16_t number_at(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

/** Returns the distance from sequence number `from` to `to`, -32768 ... 32767. */
static int distance(uint16_t from, uint16_t to)
{
    const unsigned int ahead = (uint16_t)(to - from);
    return ahead < 0x8000U ? (int)ahead : (int)ahead - 0x10000;
}

/** Returns true if a frame of the agent's reliable stream fits into the history, or was received before. */
static bool fits(const epg_xrce_guard_t *guard, uint16_t number)
{
    const uxrInputReliableStream *stream = &guard->session->streams.input_reliable[0];
    const int ahead = distance(stream->last_handled, number);
    return ahead <= (int)stream->base.history && ahead >= -OLDEST;
}

/**
 * Returns false for a late acknowledgement, of frames acknowledged before, and for a false one, of frames never sent.
 */
static bool is_timely(const epg_xrce_guard_t *guard, uint16_t first_missing)
{
    const uxrOutputReliableStream *stream = &guard->session->streams.output_reliable[0];
    const int acknowledged = distance(stream->last_acknown, (uint16_t)(first_missing - 1U));
    return acknowledged >= 0 && acknowledged <= distance(stream->last_acknown, stream->last_sent);
}

/**
 * Limits the last number of a heartbeat.  The library answers a heartbeat with one bit for each missing frame, and has
 * 16 bits for that.  Returns false if the number is too old.
 *
 * An agent cannot have sent fewer frames than were handled here, unless a forged or damaged frame has taken the number
 * of one of its frames.  The agent ignores acknowledgements of numbers that it has not reached, so its stream may stop
 * and never go on.  The session is not usable any more then.
 */
static bool limit_heartbeat(epg_xrce_guard_t *guard, uint32_t *behind, uint16_t handled, uint8_t *last)
{
    const int ahead = distance(handled, number_at(last));
    *behind = ahead < 0 ? *behind + 1U : 0U;
    guard->unknown |= *behind >= MOST_BEHIND;
    if (ahead > LARGEST_HISTORY) {
        const uint16_t limit = (uint16_t)(handled + LARGEST_HISTORY);
        last[0] = (uint8_t)(limit & 0xFFU);
        last[1] = (uint8_t)(limit >> 8);
    }
    return ahead >= -OLDEST;
}

/**
 * Reads the answer to a ping: request, object, status, a flag if the agent knows the session, properties of the agent.
 */
static void read_info(epg_xrce_guard_t *guard, const uint8_t *payload, size_t length)
{
    if (length >= 6 && payload[0] == 0 && payload[1] == PING_REQUEST && payload[4] == UXR_STATUS_OK) {
        guard->pong |= payload[5] != 0;
        guard->unknown |= payload[5] == 0;
        guard->taken = true;
    }
}

/** Returns true if an ACKNACK or a HEARTBEAT is about the stream of the services. */
static bool is_of_services(const epg_xrce_guard_t *guard, const uint8_t *payload)
{
    return payload[4] == EPG_XRCE_SERVICE_STREAM && guard->services != NULL;
}

/** Returns true if the library may get an ACKNACK.  Takes it if it is about the stream of the services. */
static bool acknack_passes(epg_xrce_guard_t *guard, const uint8_t *payload)
{
    if (is_of_services(guard, payload)) {
        epg_xrce_services_acknowledge(guard->services, number_at(payload), (uint16_t)(payload[2] << 8 | payload[3]));
        guard->taken = true;
        return false;
    }
    return payload[4] == RELIABLE && is_timely(guard, number_at(payload));
}

/** Returns true if the library may get a HEARTBEAT.  Takes it if it is about the stream of the services. */
static bool heartbeat_passes(epg_xrce_guard_t *guard, uint8_t *payload)
{
    if (is_of_services(guard, payload)) {
        const uint16_t handled = (uint16_t)(guard->services->expected - 1U);
        if (limit_heartbeat(guard, &guard->behind[1], handled, payload + 2)) {
            epg_xrce_services_heartbeat(guard->services, number_at(payload + 2));
        }
        guard->taken = true;
        return false;
    }
    const uint16_t handled = guard->session->streams.input_reliable[0].last_handled;
    return payload[4] == RELIABLE && limit_heartbeat(guard, &guard->behind[0], handled, payload + 2);
}

/** Returns the bytes of a payload that the library reads.  It would take the rest for the next submessage. */
static size_t known_part(uint8_t id, size_t length)
{
    switch (id) {
    case STATUS_AGENT:
        return 11;
    case STATUS:
        return 6;
    case ACKNACK:
    case HEARTBEAT:
        return 5;
    case TIMESTAMP_REPLY:
        return 24;
    default:
        return length;
    }
}

/** Returns true if the library may get a submessage that came on `stream`.  Its known part is there. */
static bool passes(epg_xrce_guard_t *guard, uint8_t stream, uint8_t id, uint8_t flags, uint8_t *payload, size_t length)
{
    if (!guard->open) {
        memset(guard->behind, 0, sizeof guard->behind);
        /* A STATUS_AGENT with properties must not pass: the library would write their names to an invalid pointer. */
        return id == STATUS_AGENT && stream == NO_STREAM && payload[10] == 0;
    }
    switch (id) {
    case STATUS:
    case TIMESTAMP_REPLY:
        return true;
    case INFO:
        read_info(guard, payload, length);
        return false; /* the library would read names without a limit from it */
    case DATA:
        return guard->reading && stream != NO_STREAM && (flags & FORMAT_FLAGS) == 0 && length >= 4 &&
               (payload[3] & 0x0FU) == UXR_DATAREADER_ID;
    case ACKNACK:
        /* On another stream, the library could keep the ACKNACK and read it when it is not timely any more. */
        return stream == NO_STREAM && acknack_passes(guard, payload);
    case HEARTBEAT:
        return heartbeat_passes(guard, payload);
    default:
        /* The messages of topics fit into one frame, so there are no fragments.  No other message is for a client. */
        return false;
    }
}

/** Replaces the content of a frame by two unknown submessages, so that the stream continues after its number. */
static size_t make_empty(uint8_t *frame)
{
    static const uint8_t nothing[2 * SUBHEADER] = {NOTHING, LITTLE_ENDIAN_FLAG, 0, 0, NOTHING, LITTLE_ENDIAN_FLAG};
    memcpy(frame + HEADER, nothing, sizeof nothing);
    return HEADER + sizeof nothing; /* one submessage would be too short for the library */
}

/** Moves the submessages that pass to the front.  Returns the end of the last one, 0 if the frame is malformed. */
static size_t sift(epg_xrce_guard_t *guard, uint8_t *frame, size_t size)
{
    size_t end = HEADER;
    size_t position = HEADER;
    bool acknowledged = false; /* an ACKNACK in this frame has passed; a second one may not be timely any more */
    while (size - position >= SUBHEADER) {
        const uint8_t id = frame[position];
        const uint8_t flags = frame[position + 1];
        const size_t length = number_at(frame + position + 2);
        if ((flags & LITTLE_ENDIAN_FLAG) == 0 || length > size - position - SUBHEADER) {
            return 0;
        }
        const size_t padded = (SUBHEADER + length + 3U) & ~(size_t)3U;
        const size_t taken = padded < size - position ? padded : size - position;
        const size_t known = known_part(id, length);
        if (length >= known && !(id == ACKNACK && acknowledged) &&
            passes(guard, frame[1], id, flags, frame + position + SUBHEADER, length)) {
            acknowledged |= id == ACKNACK;
            const size_t whole = (SUBHEADER + known + 3U) & ~(size_t)3U;
            const size_t kept = whole < taken ? whole : taken;
            memmove(frame + end, frame + position, kept);
            end += kept;
        }
        position += taken;
    }
    return end;
}

/** Returns true if a frame of this session is for the library, and comes at the right time. */
static bool is_for_library(const epg_xrce_guard_t *guard, const uint8_t *frame, size_t size)
{
    if (size < HEADER + SUBHEADER) {
        return false;
    }
    if (frame[1] == RELIABLE) {
        return guard->open && fits(guard, number_at(frame + 2));
    }
    return frame[1] == NO_STREAM || frame[1] == BEST_EFFORT;
}

size_t epg_xrce_guard(epg_xrce_guard_t *guard, uint8_t *frame, size_t size)
{
    const bool ours = size >= HEADER && frame[0] == EPG_XRCE_SESSION_ID;
    guard->taken = false;
    if (ours && guard->open && guard->services != NULL && frame[1] == EPG_XRCE_SERVICE_STREAM) {
        const bool good = epg_xrce_services_receive(guard->services, number_at(frame + 2), frame + HEADER,
                                                    size - HEADER, !guard->reading);
        guard->dropped += good ? 0U : 1U;
        return 0;
    }
    if (!ours || !is_for_library(guard, frame, size)) {
        guard->dropped++;
        return 0;
    }
    const size_t left = sift(guard, frame, size);
    if (left > HEADER) {
        return left;
    }
    if (frame[1] == RELIABLE && left > 0) {
        return make_empty(frame);
    }
    guard->dropped += guard->taken ? 0U : 1U;
    return 0;
}
