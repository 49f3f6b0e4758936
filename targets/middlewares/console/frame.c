/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Received frames.  They can be any sequence of bytes.
 */
#include "frame.h"

uint32_t epg_console_crc(uint32_t crc, uint8_t byte)
{
    /* Four bits at a time, with the reflected polynomial 0xEDB88320: the remainders of all numbers of four bits. */
    static const uint32_t remainders[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
        0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C,
    };
    crc ^= byte;
    crc = crc >> 4 ^ remainders[crc & 15U];
    return crc >> 4 ^ remainders[crc & 15U];
}

/** CRC-32 of any message that is followed by its own CRC-32, before the last inversion. */
#define RESIDUE UINT32_C(0xDEBB20E3)

static void append(epg_console_frame_t *frame, uint8_t *bytes, size_t size, uint8_t byte)
{
    /* The member is inverted, so that a frame that is all zero is a valid beginning. */
    frame->crc = ~epg_console_crc(~frame->crc, byte);
    if (frame->length == size) {
        frame->too_long = true;
    } else {
        bytes[frame->length++] = byte;
    }
}

/** Ends the message.  Afterwards, the byte that ended a damaged one can be the beginning of the next one. */
static epg_console_frame_part_t end(epg_console_frame_t *frame)
{
    const bool empty = !frame->open || frame->code == 0;
    const bool whole = !empty && frame->left == 0 && frame->length > EPG_CONSOLE_FRAME_CRC && ~frame->crc == RESIDUE;
    const bool too_long = frame->too_long;
    const size_t length = frame->length - EPG_CONSOLE_FRAME_CRC;
    *frame = (epg_console_frame_t){.open = !whole, .length = whole ? length : 0};
    if (whole) {
        return too_long ? EPG_CONSOLE_FRAME_TOO_LONG : EPG_CONSOLE_FRAME_WHOLE;
    }
    return empty ? EPG_CONSOLE_FRAME_MORE : EPG_CONSOLE_FRAME_DAMAGED;
}

epg_console_frame_part_t epg_console_frame_take(epg_console_frame_t *frame, uint8_t *bytes, size_t size, uint8_t byte)
{
    if (byte == 0) {
        return end(frame);
    }
    if (frame->left > 0) {
        append(frame, bytes, size, byte);
        frame->left--;
        return EPG_CONSOLE_FRAME_MORE;
    }
    if (frame->code != 0 && frame->code != EPG_CONSOLE_FRAME_RUN) {
        append(frame, bytes, size, 0); /* the zero byte after the run before */
    }
    frame->code = byte;
    frame->left = (uint8_t)(byte - 1U);
    return EPG_CONSOLE_FRAME_MORE;
}
