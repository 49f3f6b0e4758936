/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Exact conversions between doubles and decimal text.
 *
 * A number is written as the shortest text that reads back as the same double, and read as the double nearest to the
 * text.  The C library's printf() and strtod() do the same, but they need a heap, a locale and tens of kilobytes.  This
 * code uses integer arithmetic only.  Its results are therefore the same on every processor, also on one whose hardware
 * or ROM replaces very small numbers by zero.
 */
#ifndef EPG_DECIMAL_H
#define EPG_DECIMAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Bytes of the longest number that epg_decimal_write() writes: "-2.2250738585072014e-308".  No terminating zero. */
enum { EPG_DECIMAL_SIZE = 24 };

/** Largest number of digits that epg_decimal_read() accepts, without zeros at the beginning. */
enum { EPG_DECIMAL_DIGITS = 40 };

/**
 * Writes the shortest decimal number that reads back as `value`, or "nan", "inf", "-inf".  Returns its length, at most
 * EPG_DECIMAL_SIZE; no zero is appended.  The format is that of C: "0.1", "-12", "1e+21", "2.5e-07".  For a few powers
 * of two, such as 2^-24, the text has one digit more than necessary.
 */
size_t epg_decimal_write(char *text, double value);

/**
 * Reads the number in `text`: digits, with or without a point, a sign and an exponent
 * ("-1.5e-3").  The result is the nearest double; if two are equally near, the even one.  Returns false if `text` is
 * not such a number, has more than EPG_DECIMAL_DIGITS digits, or is too large for a double.
 */
bool epg_decimal_read(const char *text, double *value);

/**
 * Writes a time in nanoseconds as seconds, exactly: 1500000000 is "1.5".  Returns the length, at most EPG_DECIMAL_SIZE.
 */
size_t epg_decimal_write_seconds(char *text, uint64_t time_ns);

/** Writes a whole number.  Returns the length, at most EPG_DECIMAL_SIZE. */
size_t epg_decimal_write_integer(char *text, int64_t value);

#endif
