/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Frames over a stream.
 *
 * The serial framing is that of eProsima's agent and client ("Stream framing protocol" in their documentation).
 */
#include "xrce_link.h"

#include <string.h>

enum { BEGIN = 0x7E, ESCAPE = 0x7D, XOR = 0x20 };

/* Addresses that all clients and all agents use. */
enum { CLIENT = 1, AGENT = 0 };

/* The first byte; two addresses, length and CRC if each of their bytes is stuffed. */
enum { HEAD_AND_TAIL = 1 + 2 * 6 };

/* Largest number of bytes in one call of epg_xrce_link_receive(). */
enum { MOST_BYTES = 4096 };

/** The field of a frame that comes next. */
enum { OUTSIDE, SOURCE, DESTINATION, LENGTH_LOW, LENGTH_HIGH, PAYLOAD, CRC_LOW, CRC_HIGH };

/** CRC-16 with the reflected polynomial 0xA001, four bits at a time: the remainders of all numbers of four bits. */
static uint16_t crc_of_byte(uint16_t crc, uint8_t byte)
{
    static const uint16_t remainders[16] = {0x0000, 0xCC01, 0xD801, 0x1400, 0xF001, 0x3C00, 0x2800, 0xE401,
                                            0xA001, 0x6C00, 0x7800, 0xB401, 0x5000, 0x9C01, 0x8801, 0x4400};
    uint32_t value = crc ^ byte;
    value = value >> 4 ^ remainders[value & 15U];
    value = value >> 4 ^ remainders[value & 15U];
    return (uint16_t)value;
}

static bool is_special(uint8_t byte)
{
    return byte == BEGIN || byte == ESCAPE;
}

void epg_xrce_link_start(epg_xrce_link_t *link, const epg_stream_t *stream, uint8_t *frame, size_t frame_size)
{
    *link = (epg_xrce_link_t){.stream = stream, .frame = frame, .frame_size = frame_size};
}

void epg_xrce_link_drop(epg_xrce_link_t *link)
{
    const epg_stream_t *stream = link->stream;
    for (size_t taken = 0; taken < MOST_BYTES; taken += sizeof link->chunk) {
        if (stream->read(stream->context, link->chunk, sizeof link->chunk) == 0) {
            break;
        }
    }
    link->part = OUTSIDE;
    link->escaped = false;
    link->chunk_length = 0;
    link->chunk_position = 0;
}

size_t epg_xrce_link_cost(const epg_xrce_link_t *link, const void *data, size_t size)
{
    const uint8_t *bytes = data;
    size_t cost = size;
    if (link->stream->datagrams) {
        return cost;
    }
    for (size_t i = 0; i < size; i++) {
        cost += is_special(bytes[i]) ? 1U : 0U;
    }
    return cost + HEAD_AND_TAIL;
}

size_t epg_xrce_link_room(const epg_xrce_link_t *link)
{
    return link->stream->writable(link->stream->context);
}

/* Sending ------------------------------------------------------------------------------------------------------ */

/** Collects stuffed bytes and writes them to the stream in chunks. */
typedef struct stuffing {
    epg_xrce_link_t *link;
    size_t length;
    uint8_t bytes[EPG_XRCE_CHUNK];
} stuffing_t;

static void put_out(stuffing_t *stuffing)
{
    const epg_stream_t *stream = stuffing->link->stream;
    /* epg_xrce_link_send() has checked the room.  If the connection breaks now, the rest of the frame is lost, too. */
    (void)stream->write(stream->context, stuffing->bytes, stuffing->length);
    stuffing->length = 0;
}

static void put_plain(stuffing_t *stuffing, uint8_t byte)
{
    if (stuffing->length == sizeof stuffing->bytes) {
        put_out(stuffing);
    }
    stuffing->bytes[stuffing->length++] = byte;
}

static void put(stuffing_t *stuffing, uint8_t byte)
{
    if (is_special(byte)) {
        put_plain(stuffing, ESCAPE);
        byte ^= XOR;
    }
    put_plain(stuffing, byte);
}

bool epg_xrce_link_send(epg_xrce_link_t *link, const void *data, size_t size)
{
    const epg_stream_t *stream = link->stream;
    const uint8_t *bytes = data;
    stuffing_t stuffing = {.link = link, .length = 0};
    uint16_t crc = 0;
    const size_t room = epg_xrce_link_room(link);
    if (room < 2U * size + HEAD_AND_TAIL && room < epg_xrce_link_cost(link, data, size)) {
        return false;
    }
    if (stream->datagrams) {
        return stream->write(stream->context, data, size) == size;
    }
    put_plain(&stuffing, BEGIN);
    put(&stuffing, CLIENT);
    put(&stuffing, AGENT);
    put(&stuffing, (uint8_t)(size & 0xFFU));
    put(&stuffing, (uint8_t)(size >> 8 & 0xFFU));
    for (size_t i = 0; i < size; i++) {
        put(&stuffing, bytes[i]);
        crc = crc_of_byte(crc, bytes[i]);
    }
    put(&stuffing, (uint8_t)(crc & 0xFFU));
    put(&stuffing, (uint8_t)(crc >> 8));
    put_out(&stuffing);
    return true;
}

/* Receiving ---------------------------------------------------------------------------------------------------- */

/** Decodes one byte of a frame.  Returns true if it was the last one and the frame is valid. */
static bool take(epg_xrce_link_t *link, uint8_t byte)
{
    switch (link->part) {
    case SOURCE:
        link->part = DESTINATION;
        break;
    case DESTINATION:
        link->part = byte == CLIENT ? LENGTH_LOW : OUTSIDE;
        break;
    case LENGTH_LOW:
        link->length = byte;
        link->part = LENGTH_HIGH;
        break;
    case LENGTH_HIGH:
        link->length |= (size_t)byte << 8;
        link->position = 0;
        link->crc = 0;
        link->part = link->length > 0 && link->length <= link->frame_size ? PAYLOAD : OUTSIDE;
        link->broken += link->part == OUTSIDE ? 1U : 0U;
        break;
    case PAYLOAD:
        link->frame[link->position++] = byte;
        link->crc = crc_of_byte(link->crc, byte);
        link->part = link->position == link->length ? CRC_LOW : PAYLOAD;
        break;
    case CRC_LOW:
        link->stated_crc = byte;
        link->part = CRC_HIGH;
        break;
    case CRC_HIGH:
        link->part = OUTSIDE;
        link->stated_crc = (uint16_t)(link->stated_crc | byte << 8);
        link->broken += link->stated_crc != link->crc ? 1U : 0U;
        return link->stated_crc == link->crc;
    default:
        break;
    }
    return false;
}

/** Decodes one byte of the stream.  Returns true if a frame is complete. */
static bool take_stuffed(epg_xrce_link_t *link, uint8_t byte)
{
    if (byte == BEGIN) { /* it occurs only at the start of a frame, so the frame before it stays incomplete */
        link->broken += link->part > SOURCE ? 1U : 0U;
        link->part = SOURCE;
        link->escaped = false;
        return false;
    }
    if (byte == ESCAPE) {
        link->escaped = true;
        return false;
    }
    const uint8_t plain = link->escaped ? byte ^ XOR : byte;
    link->escaped = false;
    return take(link, plain);
}

size_t epg_xrce_link_receive(epg_xrce_link_t *link)
{
    const epg_stream_t *stream = link->stream;
    if (stream->datagrams) {
        return stream->read(stream->context, link->frame, link->frame_size);
    }
    for (size_t taken = 0; taken < MOST_BYTES; taken++) {
        if (link->chunk_position == link->chunk_length) {
            link->chunk_position = 0;
            link->chunk_length = stream->read(stream->context, link->chunk, sizeof link->chunk);
            if (link->chunk_length == 0) {
                return 0;
            }
        }
        if (take_stuffed(link, link->chunk[link->chunk_position++])) {
            return link->length;
        }
    }
    return 0;
}
