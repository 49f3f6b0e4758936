/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Frames over a stream: as they are where the transport has packets, else with the framing of XRCE's serial transport.
 *
 *     7E  source  destination  length (2)  payload  CRC of the payload (2)
 *
 * All but the first byte is stuffed: 7E and 7D become 7D and the byte xor 20.  CRC-16 with the polynomial 8005,
 * reflected, beginning with 0.  Numbers are little endian.
 *
 * The client library has this framing too; this one sends whole frames or nothing and never waits for the rest of one.
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
    uint8_t *frame;    /**< what is received */
    size_t frame_size; /**< room there */
    uint32_t broken;   /**< frames received that were too long or damaged */

    /* Of a frame that is on its way, on a stream of bytes. */
    uint8_t part; /**< which of it comes next */
    bool escaped;
    size_t length;
    size_t position;
    uint16_t crc;
    uint16_t stated_crc;
    uint8_t chunk[EPG_XRCE_CHUNK]; /**< read from the stream and not looked at yet */
    size_t chunk_length;
    size_t chunk_position;
} epg_xrce_link_t;

void epg_xrce_link_start(epg_xrce_link_t *link, const epg_stream_t *stream, uint8_t *frame, size_t frame_size);

/** Forgets what has arrived of a frame. */
void epg_xrce_link_reset(epg_xrce_link_t *link);

/** Bytes that a frame with `data` takes on the stream. */
size_t epg_xrce_link_cost(const epg_xrce_link_t *link, const void *data, size_t size);

/** How many bytes of frames there is room for. */
size_t epg_xrce_link_room(const epg_xrce_link_t *link);

/** Sends a frame; false if there is no room for all of it. */
bool epg_xrce_link_send(epg_xrce_link_t *link, const void *data, size_t size);

/** Size of the frame that has arrived and is in `link->frame`; 0: none has, or too much else has for one call. */
size_t epg_xrce_link_receive(epg_xrce_link_t *link);

#endif
