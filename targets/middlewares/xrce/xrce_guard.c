/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What of a received frame the client library gets to see.
 *
 * Source: OMG, "DDS for Extremely Resource Constrained Environments" 1.0, 8.3 (messages) and annex A (payloads).
 */
#include "xrce_guard.h"

#include <string.h>

enum {
    HEADER = 4, /* of a frame: session, stream, sequence number */
    SUBHEADER = 4,
    NO_STREAM = 0x00,
    BEST_EFFORT = 0x01, /* the only streams there are in this session */
    RELIABLE = 0x80,
    LARGEST_HISTORY = 16, /* what an ACKNACK can speak of */
    OLDEST = 4096,        /* numbers further behind are none of this session: the library would take them for new */
    MOST_BEHIND = 10,     /* heartbeats in a row that end before what has been handled: one may be late, ten are not */
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
    NOTHING = 0xFF /* an id that nobody uses */
};

enum { LITTLE_ENDIAN_FLAG = 0x01, FORMAT_FLAGS = 0x0E };

static uint16_t number_at(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

/** How far sequence number `to` lies after `from`, -32768 ... 32767. */
static int distance(uint16_t from, uint16_t to)
{
    const unsigned int ahead = (uint16_t)(to - from);
    return ahead < 0x8000U ? (int)ahead : (int)ahead - 0x10000;
}

/** Whether a frame of the agent's reliable stream fits into the history, or has been there before. */
static bool fits(const epg_xrce_guard_t *guard, uint16_t number)
{
    const uxrInputReliableStream *stream = &guard->session->streams.input_reliable[0];
    const int ahead = distance(stream->last_handled, number);
    return ahead <= (int)stream->base.history && ahead >= -OLDEST;
}

/** Late acknowledgements speak of what was acknowledged long ago, false ones of what was never sent. */
static bool is_timely(const epg_xrce_guard_t *guard, uint16_t first_missing)
{
    const uxrOutputReliableStream *stream = &guard->session->streams.output_reliable[0];
    const int acknowledged = distance(stream->last_acknown, (uint16_t)(first_missing - 1U));
    return acknowledged >= 0 && acknowledged <= distance(stream->last_acknown, stream->last_sent);
}

/**
 * The library answers with one bit for each frame that it has not got; there are 16.  False: the number is too old.
 *
 * An agent that has sent less than has been handled here has not sent all of that: a forged or damaged frame has taken
 * the number of one of its own.  Acknowledgements of numbers that it has not reached mean nothing to it, so that its
 * stream may stand still for ever: the session is no good any more.
 */
static bool limit_heartbeat(epg_xrce_guard_t *guard, uint8_t *last)
{
    const uint16_t handled = guard->session->streams.input_reliable[0].last_handled;
    const int ahead = distance(handled, number_at(last));
    guard->behind = ahead < 0 ? guard->behind + 1U : 0U;
    guard->unknown |= guard->behind >= MOST_BEHIND;
    if (ahead > LARGEST_HISTORY) {
        const uint16_t limit = (uint16_t)(handled + LARGEST_HISTORY);
        last[0] = (uint8_t)(limit & 0xFFU);
        last[1] = (uint8_t)(limit >> 8);
    }
    return ahead >= -OLDEST;
}

/** The answer to a ping: request, object, status, whether the agent knows the session, and what the agent is. */
static void read_info(epg_xrce_guard_t *guard, const uint8_t *payload, size_t length)
{
    if (length >= 6 && payload[0] == 0 && payload[1] == PING_REQUEST && payload[4] == UXR_STATUS_OK) {
        guard->pong |= payload[5] != 0;
        guard->unknown |= payload[5] == 0;
    }
}

/** Whether the library may see a submessage that came on `stream`. */
static bool passes(epg_xrce_guard_t *guard, uint8_t stream, uint8_t id, uint8_t flags, uint8_t *payload, size_t length)
{
    if (!guard->open) {
        guard->behind = 0;
        /* With properties, whose names the library would write to where no pointer leads. */
        return id == STATUS_AGENT && stream == NO_STREAM && length >= 11 && payload[10] == 0;
    }
    switch (id) {
    case STATUS:
        return length >= 6;
    case INFO:
        read_info(guard, payload, length);
        return false; /* the library would read names without end in it */
    case DATA: {
        const unsigned int kind = length >= 4 ? payload[3] & 0x0FU : 0U;
        return guard->reading && stream != NO_STREAM && kind == UXR_DATAREADER_ID && (flags & FORMAT_FLAGS) == 0;
    }
    case ACKNACK:
        /* On a stream the library might keep it, and look at it when it is timely no longer. */
        return stream == NO_STREAM && length >= 5 && payload[4] == RELIABLE && is_timely(guard, number_at(payload));
    case HEARTBEAT:
        return length >= 5 && payload[4] == RELIABLE && limit_heartbeat(guard, payload + 2);
    case TIMESTAMP_REPLY:
        return length >= 24;
    default:
        /* Of fragments there are none in what fits into a frame, and no other message is for this target. */
        return false;
    }
}

/** Bytes of a payload that the library reads; the rest it would take for the next submessage. */
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

/** The stream goes on after a frame of which nothing is let through. */
static size_t make_empty(uint8_t *frame)
{
    static const uint8_t nothing[2 * SUBHEADER] = {NOTHING, LITTLE_ENDIAN_FLAG, 0, 0, NOTHING, LITTLE_ENDIAN_FLAG};
    memcpy(frame + HEADER, nothing, sizeof nothing);
    return HEADER + sizeof nothing; /* one would be too short for the library */
}

/** Moves the submessages that pass to the front; returns where they end, 0 if the frame is none. */
static size_t sift(epg_xrce_guard_t *guard, uint8_t *frame, size_t size)
{
    size_t end = HEADER;
    size_t position = HEADER;
    bool acknowledged = false; /* by an ACKNACK in this frame: what is timely has changed */
    while (size - position >= SUBHEADER) {
        const uint8_t id = frame[position];
        const uint8_t flags = frame[position + 1];
        const size_t length = number_at(frame + position + 2);
        if ((flags & LITTLE_ENDIAN_FLAG) == 0 || length > size - position - SUBHEADER) {
            return 0;
        }
        const size_t padded = (SUBHEADER + length + 3U) & ~(size_t)3U;
        const size_t taken = padded < size - position ? padded : size - position;
        if (!(id == ACKNACK && acknowledged) &&
            passes(guard, frame[1], id, flags, frame + position + SUBHEADER, length)) {
            acknowledged |= id == ACKNACK;
            const size_t known = (SUBHEADER + known_part(id, length) + 3U) & ~(size_t)3U;
            const size_t kept = known < taken ? known : taken;
            memmove(frame + end, frame + position, kept);
            end += kept;
        }
        position += taken;
    }
    return end;
}

size_t epg_xrce_guard(epg_xrce_guard_t *guard, uint8_t *frame, size_t size)
{
    const bool whole = size >= HEADER + SUBHEADER && frame[0] == EPG_XRCE_SESSION_ID;
    const bool reliable = whole && frame[1] == RELIABLE;
    if (!whole || (!reliable && frame[1] != NO_STREAM && frame[1] != BEST_EFFORT) ||
        (reliable && (!guard->open || !fits(guard, number_at(frame + 2))))) {
        guard->dropped++;
        return 0;
    }
    const bool pong = guard->pong || guard->unknown;
    const size_t left = sift(guard, frame, size);
    if (left > HEADER) {
        return left;
    }
    if (reliable && left > 0) {
        return make_empty(frame);
    }
    guard->dropped += (guard->pong || guard->unknown) && !pong ? 0U : 1U;
    return 0;
}
