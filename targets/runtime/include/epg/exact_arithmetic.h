/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Stops the compilation if an option of the compiler changes the results of arithmetic.
 *
 * A controller computes the same bits in the simulation and on every processor.  Options such as `-ffast-math` and
 * `-fsingle-precision-constant` let the compiler compute other bits.  EPG's CMake functions undo these options, and
 * include this header into each source of EPG and of a model.
 */
#ifndef EPG_EXACT_ARITHMETIC_H
#define EPG_EXACT_ARITHMETIC_H

#ifdef __GNUC__
#pragma GCC system_header /* warnings that a project chooses are for its own code */
#endif

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) ||                         \
    defined(__NO_SIGNED_ZEROS__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "EPG: an option of the compiler changes results: remove -ffast-math, -Ofast and their parts"
#endif

#ifdef __cplusplus
static_assert(sizeof(0.1) == 8, "EPG: constants must have double precision: remove -fsingle-precision-constant");
#else
_Static_assert(sizeof(0.1) == 8, "EPG: constants must have double precision: remove -fsingle-precision-constant");
#endif

#endif
