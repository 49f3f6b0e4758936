/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Whole numbers of up to 1376 bits: as large as the decimal representation of a double needs.
 *
 * The largest is 10^365 (1213 bits), shifted by the 53 bits of a quotient.
 */
#ifndef EPG_BIG_H
#define EPG_BIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { EPG_BIG_WORDS = 43 };

/** Little-endian; words from `used` on mean zero and hold anything. */
typedef struct epg_big {
    size_t used;
    uint32_t words[EPG_BIG_WORDS];
} epg_big_t;

void epg_big_set(epg_big_t *big, uint64_t value);

/** big = big * factor + summand */
void epg_big_multiply(epg_big_t *big, uint32_t factor, uint32_t summand);

/** big = big * 10^exponent */
void epg_big_scale(epg_big_t *big, unsigned int exponent);

/** big = big * 2^bits */
void epg_big_shift(epg_big_t *big, unsigned int bits);

/** Number of bits of `big` without zeros at the beginning; 0 for zero. */
unsigned int epg_big_bits(const epg_big_t *big);

/** Negative, 0 or positive as a is less than, equal to or more than b. */
int epg_big_compare(const epg_big_t *a, const epg_big_t *b);

/** a = a + b */
void epg_big_add(epg_big_t *a, const epg_big_t *b);

/** a = a - b, where a >= b */
void epg_big_subtract(epg_big_t *a, const epg_big_t *b);

#endif
