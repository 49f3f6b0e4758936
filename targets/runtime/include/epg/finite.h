/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Finds NaN and infinity by their bits.
 *
 * Comparisons and isfinite() are no help everywhere: limiters hide NaN, `-ffast-math` lets a compiler assume there is
 * none, and the RP2040's ROM routines turn it into infinity.
 */
#ifndef EPG_FINITE_H
#define EPG_FINITE_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static_assert(sizeof(double) == sizeof(uint64_t), "a double is IEEE 754 binary64");

/** True unless `value` is NaN or infinite: those have all exponent bits set (IEEE 754-2019, 3.4). */
static inline bool epg_is_finite(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (bits >> 52 & 0x7FFU) != 0x7FFU;
}

/** Puts `value` into `place`; one that is not finite (a conversion that overflows) leaves the one before it there. */
static inline void epg_assign_finite(double *place, double value)
{
    if (epg_is_finite(value)) {
        *place = value;
    }
}

#endif
