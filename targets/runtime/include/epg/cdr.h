/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Common Data Representation (CDR): the bytes of a ROS 2 message on the wire.
 *
 * Numbers are little endian.  Each number is aligned to its own size, counted from the start of the message.  The
 * encapsulation header of four bytes, which DDS puts before a message, is not part of it.
 *
 *     epg_cdr_writer_t writer = {.data = buffer, .size = sizeof buffer};
 *     epg_cdr_write_u32(&writer, 7);
 *     epg_cdr_write_f64(&writer, 0.5);
 *     return writer.failed ? 0 : writer.length; // 16: four bytes, four of padding, eight bytes
 *
 * Writers and readers remember a failure in `failed`.  The caller therefore checks only once, at the end.
 *
 * Source: OMG, "DDS Interoperability Wire Protocol" 2.5, 10.2 (classic CDR, "PLAIN_CDR").
 */
#ifndef EPG_CDR_H
#define EPG_CDR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Writes a message to `data`, which has room for `size` bytes. */
typedef struct epg_cdr_writer {
    unsigned char *data;
    size_t size;
    size_t length; /**< number of bytes written so far */
    bool failed;   /**< a value did not fit; all later values are ignored */
} epg_cdr_writer_t;

/** Reads a message of `size` bytes.  After a failure, numbers are 0. */
typedef struct epg_cdr_reader {
    const unsigned char *data;
    size_t size;
    size_t position; /**< number of bytes read so far */
    bool failed;     /**< the message ended too early, or a text was malformed */
} epg_cdr_reader_t;

void epg_cdr_write_u8(epg_cdr_writer_t *writer, uint8_t value);
void epg_cdr_write_u32(epg_cdr_writer_t *writer, uint32_t value);
void epg_cdr_write_i32(epg_cdr_writer_t *writer, int32_t value);
void epg_cdr_write_f32(epg_cdr_writer_t *writer, float value);
void epg_cdr_write_f64(epg_cdr_writer_t *writer, double value);
/** Writes a text with its length and its terminating zero. */
void epg_cdr_write_string(epg_cdr_writer_t *writer, const char *text);

uint8_t epg_cdr_read_u8(epg_cdr_reader_t *reader);
uint32_t epg_cdr_read_u32(epg_cdr_reader_t *reader);
int32_t epg_cdr_read_i32(epg_cdr_reader_t *reader);
float epg_cdr_read_f32(epg_cdr_reader_t *reader);
double epg_cdr_read_f64(epg_cdr_reader_t *reader);
/** Reads the bits of a number of `size` bytes: 1, 2, 4 or 8. */
uint64_t epg_cdr_read_bits(epg_cdr_reader_t *reader, size_t size);
/** Skips `count` numbers of `size` bytes each. */
void epg_cdr_skip(epg_cdr_reader_t *reader, size_t size, uint16_t count);
/**
 * Skips a sequence of numbers of `size` bytes each.  Returns the number of its elements; `*first` is the position of
 * the first one.  If the sequence is longer than the message, the reader fails and the result is 0.
 */
size_t epg_cdr_read_sequence(epg_cdr_reader_t *reader, size_t size, size_t *first);
/** Reads a text.  Returns its place in the message, zero-terminated; NULL, and the reader fails, if it is malformed. */
const char *epg_cdr_read_string(epg_cdr_reader_t *reader);

#endif
