/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Work with numbers of type double that a processor without double arithmetic can do with integers.
 *
 * Such a processor (Cortex-M0+, Cortex-M33, Cortex-M4F) calls a function for each comparison and each conversion.  On
 * an RP2040 one call takes 0.5 to 4 us.  The functions below give the same results to the bit, by fewer instructions.
 * A processor with double arithmetic uses its own instructions.
 */
#ifndef EPG_SOFT_DOUBLE_H
#define EPG_SOFT_DOUBLE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Bit 3 of __ARM_FP: double arithmetic (Arm C Language Extensions, 6.5.1).  A test can define it before. */
#ifndef EPG_SOFT_DOUBLE
#if defined(__ARM_ARCH) && (!defined(__ARM_FP) || (__ARM_FP & 8) == 0)
#define EPG_SOFT_DOUBLE 1
#else
#define EPG_SOFT_DOUBLE 0
#endif
#endif

/** Returns an integer with the order of the numbers: 0 for both zeros, negative for negative numbers. */
static inline int64_t epg_order(double value)
{
    int64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits < 0 ? INT64_MIN - bits : bits;
}

/** Returns true if `a` is less than `b`.  Neither may be NaN. */
static inline bool epg_less(double a, double b)
{
    return EPG_SOFT_DOUBLE ? epg_order(a) < epg_order(b) : a < b;
}

/** Returns true if `a` is less than `b` or equal to it.  Neither may be NaN. */
static inline bool epg_at_most(double a, double b)
{
    return EPG_SOFT_DOUBLE ? epg_order(a) <= epg_order(b) : a <= b;
}

/** Returns `offset + (double)number * scale`.  `scale` must not be 0: the sign of a zero could differ. */
static inline double epg_scaled(int64_t number, double scale, double offset)
{
    uint64_t bits;
    memcpy(&bits, &offset, sizeof bits);
    const int32_t small = (int32_t)number;
    if (!EPG_SOFT_DOUBLE || small != number || small == 0 || bits != 0U) {
        return offset + (double)number * scale;
    }
    return (double)small * scale; /* the sum of 0 and a number that is not 0, because |small| is at least 1 */
}

#endif
