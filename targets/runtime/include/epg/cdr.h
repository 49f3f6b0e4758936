/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Common Data Representation, as ROS 2 messages have it on the wire: little endian, each number aligned to its size
 * counted from the message's begin.  The encapsulation header of four bytes is not part of it.
 *
 * Source: OMG, "DDS Interoperability Wire Protocol" 2.5, 10.2 (classic CDR, "PLAIN_CDR").
 *
 * Writers and readers remember that something did not fit or was malformed, so that only the end need be checked.
 */
#ifndef EPG_CDR_H
#define EPG_CDR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct epg_cdr_writer {
    unsigned char *data;
    size_t size;
    size_t length; /**< bytes written so far */
    bool failed;   /**< something did not fit */
} epg_cdr_writer_t;

typedef struct epg_cdr_reader {
    const unsigned char *data;
    size_t size;
    size_t position;
    bool failed; /**< the message ends too early, or a text is none */
} epg_cdr_reader_t;

void epg_cdr_write_u8(epg_cdr_writer_t *writer, uint8_t value);
void epg_cdr_write_u32(epg_cdr_writer_t *writer, uint32_t value);
void epg_cdr_write_i32(epg_cdr_writer_t *writer, int32_t value);
void epg_cdr_write_f32(epg_cdr_writer_t *writer, float value);
void epg_cdr_write_f64(epg_cdr_writer_t *writer, double value);
/** A text with its length and its terminating zero. */
void epg_cdr_write_string(epg_cdr_writer_t *writer, const char *text);

uint8_t epg_cdr_read_u8(epg_cdr_reader_t *reader);
uint32_t epg_cdr_read_u32(epg_cdr_reader_t *reader);
int32_t epg_cdr_read_i32(epg_cdr_reader_t *reader);
float epg_cdr_read_f32(epg_cdr_reader_t *reader);
double epg_cdr_read_f64(epg_cdr_reader_t *reader);
/**
 * The length of a sequence of numbers of `size` bytes, which is skipped; `*first` is the place of the first one.  A
 * sequence that the message does not hold has failed, and no elements.
 */
size_t epg_cdr_read_sequence(epg_cdr_reader_t *reader, size_t size, size_t *first);
/** Where the text begins in the message, zero-terminated; NULL if there is none. */
const char *epg_cdr_read_string(epg_cdr_reader_t *reader);

#endif
