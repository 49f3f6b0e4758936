/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Detects NaN and infinity by their bits.
 *
 * Comparisons and isfinite() do not detect them everywhere.  Limiters hide NaN.  `-ffast-math` lets a compiler assume
 * that NaN does not occur.  The floating-point routines in the RP2040's ROM turn NaN into infinity.
 */
#ifndef EPG_FINITE_H
#define EPG_FINITE_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static_assert(sizeof(double) == sizeof(uint64_t), "a double is IEEE 754 binary64");

/** Returns false if `value` is NaN or infinite: both have all exponent bits set (IEEE 754-2019, 3.4). */
static inline bool epg_is_finite(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (uint32_t)(bits >> 32) << 1 < 0xFFE00000U; /* without the sign, the exponent has the highest bits */
}

/** Stores `value` in `*place` if it is finite.  Otherwise (a conversion overflowed) `*place` keeps its value. */
static inline void epg_assign_finite(double *place, double value)
{
    if (epg_is_finite(value)) {
        *place = value;
    }
}

#endif
