/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Arithmetic of large whole numbers, by the schoolbook.
 */
#include "big.h"

static void trim(epg_big_t *big)
{
    while (big->used > 0 && big->words[big->used - 1] == 0) {
        big->used--;
    }
}

void epg_big_set(epg_big_t *big, uint64_t value)
{
    big->words[0] = (uint32_t)(value & 0xFFFFFFFFU);
    big->words[1] = (uint32_t)(value >> 32);
    big->used = 2;
    trim(big);
}

void epg_big_multiply(epg_big_t *big, uint32_t factor, uint32_t summand)
{
    uint64_t carry = summand;
    for (size_t i = 0; i < big->used; i++) {
        carry += (uint64_t)big->words[i] * factor;
        big->words[i] = (uint32_t)(carry & 0xFFFFFFFFU);
        carry >>= 32;
    }
    if (carry != 0 && big->used < EPG_BIG_WORDS) {
        big->words[big->used++] = (uint32_t)carry;
    }
}

void epg_big_scale(epg_big_t *big, unsigned int exponent)
{
    for (; exponent >= 9; exponent -= 9) {
        epg_big_multiply(big, 1000000000U, 0);
    }
    for (; exponent > 0; exponent--) {
        epg_big_multiply(big, 10, 0);
    }
}

void epg_big_shift(epg_big_t *big, unsigned int bits)
{
    const size_t whole = bits / 32U;
    const unsigned int rest = bits % 32U;
    epg_big_multiply(big, (uint32_t)1U << rest, 0);
    if (whole == 0 || big->used == 0 || big->used + whole > EPG_BIG_WORDS) {
        return;
    }
    for (size_t i = big->used; i > 0; i--) {
        big->words[i - 1 + whole] = big->words[i - 1];
    }
    for (size_t i = 0; i < whole; i++) {
        big->words[i] = 0;
    }
    big->used += whole;
}

unsigned int epg_big_bits(const epg_big_t *big)
{
    if (big->used == 0) {
        return 0;
    }
    unsigned int bits = (unsigned int)(big->used - 1) * 32U;
    for (uint32_t word = big->words[big->used - 1]; word != 0; word >>= 1) {
        bits++;
    }
    return bits;
}

int epg_big_compare(const epg_big_t *a, const epg_big_t *b)
{
    if (a->used != b->used) {
        return a->used < b->used ? -1 : 1;
    }
    for (size_t i = a->used; i > 0; i--) {
        if (a->words[i - 1] != b->words[i - 1]) {
            return a->words[i - 1] < b->words[i - 1] ? -1 : 1;
        }
    }
    return 0;
}

void epg_big_add(epg_big_t *a, const epg_big_t *b)
{
    const size_t used = a->used > b->used ? a->used : b->used;
    uint64_t carry = 0;
    for (size_t i = 0; i < used; i++) {
        carry += (uint64_t)(i < a->used ? a->words[i] : 0U) + (i < b->used ? b->words[i] : 0U);
        a->words[i] = (uint32_t)(carry & 0xFFFFFFFFU);
        carry >>= 32;
    }
    a->used = used;
    if (carry != 0 && a->used < EPG_BIG_WORDS) {
        a->words[a->used++] = (uint32_t)carry;
    }
}

void epg_big_subtract(epg_big_t *a, const epg_big_t *b)
{
    uint32_t borrow = 0;
    for (size_t i = 0; i < a->used; i++) {
        const uint64_t subtrahend = (uint64_t)(i < b->used ? b->words[i] : 0U) + borrow;
        borrow = a->words[i] < subtrahend ? 1U : 0U;
        a->words[i] = (uint32_t)((a->words[i] + ((uint64_t)borrow << 32)) - subtrahend);
    }
    trim(a);
}
