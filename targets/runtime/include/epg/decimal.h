/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Decimal numbers, exactly: the shortest text that reads back as the same double, and the double nearest to a text.
 *
 * For where the C library's printf() and strtod() are too much: they bring a heap, a locale and tens of kilobytes.
 * Only integer arithmetic, so the result is the same everywhere, also where hardware or ROM flushes small numbers.
 */
#ifndef EPG_DECIMAL_H
#define EPG_DECIMAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Room for any number that epg_decimal_write() writes: "-2.2250738585072014e-308", without a terminating zero. */
enum { EPG_DECIMAL_SIZE = 24 };

/** Most digits that epg_decimal_read() takes, zeros at the beginning apart. */
enum { EPG_DECIMAL_DIGITS = 40 };

/**
 * Writes the shortest decimal number that is nearest to `value` of all doubles, or "nan", "inf", "-inf".  Returns its
 * length, at most EPG_DECIMAL_SIZE; no zero is appended.  "0.1", "-12", "1e+21", "2.5e-07": as C writes them.
 * A few powers of two, such as 2^-24, have a digit more than they need.
 */
size_t epg_decimal_write(char *text, double value);

/**
 * Reads the number that fills `text`: digits with or without point, sign and exponent ("-1.5e-3").  The result is the
 * double nearest to it, of two the even one.  False if it is no such number, has more than EPG_DECIMAL_DIGITS digits
 * or is too large for a double.
 */
bool epg_decimal_read(const char *text, size_t length, double *value);

/** Writes a time in seconds, exactly: 1500000000 is "1.5".  Returns its length, at most EPG_DECIMAL_SIZE. */
size_t epg_decimal_write_seconds(char *text, uint64_t time_ns);

/** Writes a whole number.  Returns its length, at most EPG_DECIMAL_SIZE. */
size_t epg_decimal_write_integer(char *text, int64_t value);

#endif
