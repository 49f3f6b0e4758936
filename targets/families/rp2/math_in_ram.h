/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Puts the Pico SDK's arithmetic and mathematics into RAM, as far as PICO_DOUBLE_IN_RAM and PICO_FLOAT_IN_RAM do not.
 *
 * The compiler reads this file before double_math.c, float_math.c, and the sources double_aeabi_rp2040.S and
 * float_aeabi_rp2040.S (-include).  A control cycle can call their functions, and must not read flash.
 */
#ifndef EPG_PICO_MATH_IN_RAM_H
#define EPG_PICO_MATH_IN_RAM_H

#ifdef __ASSEMBLER__

/*
 * The tests for NaN are in ".section .text", all other functions in sections that the SDK's options put into RAM.
 * Another executable of the same CMake folder can lack these options.
 */
#if PICO_DOUBLE_IN_RAM || PICO_FLOAT_IN_RAM
#define text time_critical.check_nan, "ax"
#endif

#else

#include <math.h>

#include "pico/double.h"
#include "pico/float.h"

/* A section with the line's number in its name, so that the linker can remove unused functions. */
#define EPG_PICO_STRING_(text) #text
#define EPG_PICO_STRING(number) EPG_PICO_STRING_(number)
#define EPG_PICO_IN_RAM __attribute__((section(".time_critical.math." EPG_PICO_STRING(__LINE__))))

/* The SDK's name of a function that replaces the C library's. */
#undef WRAPPER_FUNC
#define WRAPPER_FUNC(x) EPG_PICO_IN_RAM __wrap_##x

/* The functions that they call. */
#define static static EPG_PICO_IN_RAM

#endif

#endif
