/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The writer of a reply.
 */
#include "reply.h"

#include <string.h>

/** Writes `size` bytes, of which those in the window are kept. */
static void put(epg_reply_t *reply, const void *bytes, size_t size)
{
    const size_t start = reply->position;
    const size_t end = start + size;
    const size_t from = start < reply->begin ? reply->begin : start;
    const size_t to = end > reply->end ? reply->end : end;
    if (from < to) {
        memcpy(reply->window + (from - reply->begin), (const unsigned char *)bytes + (from - start), to - from);
    }
    reply->position = end;
}

/** Writes a number of `size` bytes, after padding with zeros to its alignment. */
static void put_bits(epg_reply_t *reply, uint64_t bits, size_t size)
{
    static const unsigned char zeros[sizeof bits] = {0};
    unsigned char bytes[sizeof bits];
    put(reply, zeros, (size - reply->position % size) % size);
    for (size_t i = 0; i < size; i++) {
        bytes[i] = (unsigned char)(bits >> (8U * i));
    }
    put(reply, bytes, size);
}

void epg_reply_u8(epg_reply_t *reply, uint8_t value)
{
    put(reply, &value, sizeof value);
}

void epg_reply_u32(epg_reply_t *reply, uint32_t value)
{
    put_bits(reply, value, sizeof value);
}

void epg_reply_u64(epg_reply_t *reply, uint64_t value)
{
    put_bits(reply, value, sizeof value);
}

void epg_reply_f64(epg_reply_t *reply, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_bits(reply, bits, sizeof bits);
}

void epg_reply_string(epg_reply_t *reply, const char *text)
{
    epg_reply_text(reply, text, strlen(text));
}

void epg_reply_text(epg_reply_t *reply, const char *text, size_t length)
{
    epg_reply_u32(reply, (uint32_t)length + 1U);
    put(reply, text, length);
    put(reply, "", 1);
}

void epg_reply_pieces(epg_reply_t *reply, const char *first, const char *second, const char *third, const char *fourth,
                      const char *fifth)
{
    const char *const pieces[] = {first, second, third, fourth, fifth};
    size_t length = 0;
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++) {
        length += strlen(pieces[i]);
    }
    epg_reply_u32(reply, (uint32_t)length + 1U);
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++) {
        put(reply, pieces[i], strlen(pieces[i]));
    }
    put(reply, "", 1);
}
