/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The writer of a reply: as epg_cdr_writer_t, but it keeps only the bytes of a window and passes over all others.
 *
 * A reply of any size can so be written piece by piece, without a buffer for the whole of it.
 */
#ifndef EPG_REPLY_H
#define EPG_REPLY_H

#include <stddef.h>
#include <stdint.h>

typedef struct epg_reply {
    unsigned char *window; /**< receives the bytes `begin` ... `end` - 1 of the reply; may be NULL if there are none */
    size_t begin;
    size_t end;
    size_t position; /**< position of the next byte in the reply */
} epg_reply_t;

void epg_reply_u8(epg_reply_t *reply, uint8_t value);
void epg_reply_u32(epg_reply_t *reply, uint32_t value);
void epg_reply_u64(epg_reply_t *reply, uint64_t value);
void epg_reply_f64(epg_reply_t *reply, double value);
/** Writes a text with its length and its terminating zero. */
void epg_reply_string(epg_reply_t *reply, const char *text);
/** Writes the first `length` characters of a text. */
void epg_reply_text(epg_reply_t *reply, const char *text, size_t length);
/** Writes a text of five pieces. */
void epg_reply_pieces(epg_reply_t *reply, const char *first, const char *second, const char *third, const char *fourth,
                      const char *fifth);

#endif
