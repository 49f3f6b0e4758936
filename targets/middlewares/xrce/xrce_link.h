/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Frames over a stream.
 *
 * On a transport with packets (UDP), a frame is a packet.  On a stream of bytes, it has the framing of XRCE's serial
 * transport; numbers are hexadecimal:
 *
 *     7E  source  destination  length (2)  payload  CRC of the payload (2)
 *
 * All bytes but the first are stuffed: 7E and 7D become 7D and the byte xor 20.  The CRC-16 has the polynomial 8005,
 * reflected, and begins with 0.  Length and CRC are little endian.
 *
 * The client library has this framing, too.  This implementation, however, sends a frame completely or not at all, and
 * never waits for the rest of a received one.
 */
#ifndef EPG_XRCE_LINK_H
#define EPG_XRCE_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/stream.h"

enum { EPG_XRCE_CHUNK = 64 };

typedef struct epg_xrce_link {
    const epg_stream_t *stream;
    uint8_t *frame;    /**< the received frame */
    size_t frame_size; /**< bytes of room for it */
    uint32_t broken;   /**< received frames that were too long or damaged */

    /* These members describe a frame that has partly arrived on a stream of bytes. */
    uint8_t part; /**< the field that comes next */
    bool escaped;
    size_t length;
    size_t position;
    uint16_t crc;
    uint16_t stated_crc;
    uint8_t chunk[EPG_XRCE_CHUNK]; /**< bytes that were read from the stream, but not yet decoded */
    size_t chunk_length;
    size_t chunk_position;
} epg_xrce_link_t;

/** Starts on `stream`, with room for a received frame of `frame_size` bytes. */
void epg_xrce_link_start(epg_xrce_link_t *link, const epg_stream_t *stream, uint8_t *frame, size_t frame_size);

/** Drops all bytes that have arrived: while nobody is connected, so that the next agent's session begins without them. */
void epg_xrce_link_drop(epg_xrce_link_t *link);

/** Returns the number of bytes that a frame with `data` takes on the stream. */
size_t epg_xrce_link_cost(const epg_xrce_link_t *link, const void *data, size_t size);

/** Returns the number of bytes for which the stream has room. */
size_t epg_xrce_link_room(const epg_xrce_link_t *link);

/** Sends a frame.  Returns false if there is not enough room for all of it. */
bool epg_xrce_link_send(epg_xrce_link_t *link, const void *data, size_t size);

/**
 * Receives a frame into `link->frame` and returns its size.  Returns 0 if no frame is complete yet; also after a
 * certain number of other bytes, so that the time of one call is bounded.
 */
size_t epg_xrce_link_receive(epg_xrce_link_t *link);

#endif
