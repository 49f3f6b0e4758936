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

static void append(epg_console_frame_t *frame, uint8_t *bytes, size_t size, uint8_t byte)
{
    if (frame->length == size) {
        frame->too_long = true;
    } else {
        bytes[frame->length++] = byte;
    }
}

/** Returns true if the message is complete, and its CRC is right. */
static bool is_right(epg_console_frame_t *frame, const uint8_t *bytes)
{
    if (frame->too_long || frame->left > 0 || frame->length <= EPG_CONSOLE_FRAME_CRC) {
        return false;
    }
    const size_t length = frame->length - EPG_CONSOLE_FRAME_CRC;
    uint32_t crc = EPG_CONSOLE_CRC_START;
    uint32_t sent = 0;
    for (size_t i = 0; i < length; i++) {
        crc = epg_console_crc(crc, bytes[i]);
    }
    for (size_t i = 0; i < EPG_CONSOLE_FRAME_CRC; i++) {
        sent |= (uint32_t)bytes[length + i] << 8U * i;
    }
    frame->length = length;
    return sent == (crc ^ EPG_CONSOLE_CRC_START);
}

static epg_console_frame_part_t end(epg_console_frame_t *frame, const uint8_t *bytes)
{
    const bool empty = frame->open && frame->code == 0;
    const bool right = !empty && frame->open && is_right(frame, bytes);
    const bool damaged = !empty && frame->open && !right;
    frame->open = !right;
    frame->too_long = false;
    frame->code = 0;
    frame->left = 0;
    if (!right) {
        frame->length = 0;
    }
    return right ? EPG_CONSOLE_FRAME_WHOLE : damaged ? EPG_CONSOLE_FRAME_DAMAGED : EPG_CONSOLE_FRAME_MORE;
}

epg_console_frame_part_t epg_console_frame_take(epg_console_frame_t *frame, uint8_t *bytes, size_t size, uint8_t byte)
{
    if (byte == 0) {
        return end(frame, bytes);
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
