/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The PIO programs of src/pico_quadrature.pio as words: no header of an SDK is needed, so that any driver can use them.
 *
 * Each program must be loaded at address 0, once per PIO block.  A state machine is set up with
 * - IN base: the lower of the two pins; IN shifts left, OUT shifts right, no autopush and no autopull; divider 1;
 * - wrap from `..._WRAP` to `..._WRAP_TARGET`, first instruction `..._START`;
 * - Y 0 and OSR the present state of the pins (bit 0: the lower one), by instructions executed before it is enabled.
 *
 * With the lower pin A and the upper pin B, a count rises when A leads.
 */
#ifndef EPG_PICO_QUADRATURE_PROGRAM_H
#define EPG_PICO_QUADRATURE_PROGRAM_H

#include <stdint.h>

#define EPG_PICO_QUADRATURE_ORIGIN 0u

/** PIO flag that a state machine raises when both pins change at once: this plus its number (0 ... 3). */
#define EPG_PICO_QUADRATURE_SKIPPED_FLAG 4u

/** Program `count`: pushes the count, modulo 2^32. */
#define EPG_PICO_QUADRATURE_COUNT_LENGTH 28u
#define EPG_PICO_QUADRATURE_COUNT_START 19u
#define EPG_PICO_QUADRATURE_COUNT_WRAP_TARGET 19u
#define EPG_PICO_QUADRATURE_COUNT_WRAP 27u
/** Shortest distance of two edges that is counted exactly, in cycles: one more than the program needs, because a
 * synchroniser may take one of two edges a cycle later. */
#define EPG_PICO_QUADRATURE_COUNT_EDGE_CYCLES 10u
/** Longest time between two pushes at that distance, in cycles. */
#define EPG_PICO_QUADRATURE_COUNT_SILENCE_CYCLES 90u

static const uint16_t epg_pico_quadrature_count_program[EPG_PICO_QUADRATURE_COUNT_LENGTH] = {
    0x0011, 0x0019, 0x0010, 0x0017, 0x0010, 0x0011, 0x0017, 0x0019, 0x0019, 0x0017, 0x0011, 0x0010, 0x0017, 0x0010,
    0x0019, 0x0011, 0x0093, 0xa0c2, 0x8000, 0x60c2, 0x4002, 0xa0e6, 0xa0a6, 0xc014, 0x0011, 0xa04a, 0x009b, 0xa04a,
};

/**
 * Program `velocity`: pushes the count modulo 2^16 in the upper half of a word, and in the lower half the complement of
 * the samples without change since the last edge, modulo 2^16.
 */
#define EPG_PICO_QUADRATURE_VELOCITY_LENGTH 32u
#define EPG_PICO_QUADRATURE_VELOCITY_START 22u
#define EPG_PICO_QUADRATURE_VELOCITY_WRAP_TARGET 22u
#define EPG_PICO_QUADRATURE_VELOCITY_WRAP 31u
#define EPG_PICO_QUADRATURE_VELOCITY_EDGE_CYCLES 12u
#define EPG_PICO_QUADRATURE_VELOCITY_SILENCE_CYCLES 70u
/** Cycles of a sample that finds no change, and from an edge to the first push after it (mean). */
#define EPG_PICO_QUADRATURE_VELOCITY_SAMPLE_CYCLES 9u
#define EPG_PICO_QUADRATURE_VELOCITY_LATENCY_CYCLES 22u

static const uint16_t epg_pico_quadrature_velocity_program[EPG_PICO_QUADRATURE_VELOCITY_LENGTH] = {
    0x0012, 0x001c, 0x0010, 0x001a, 0x0010, 0x0012, 0x001a, 0x001c, 0x001c, 0x001a, 0x0012,
    0x0010, 0x001a, 0x0010, 0x001c, 0x0012, 0xa02b, 0x0096, 0x0053, 0x4050, 0x4030, 0x8000,
    0x60c2, 0x4002, 0xa0e6, 0xa0a6, 0xc014, 0x0012, 0xa02b, 0xa04a, 0x009f, 0xa04a,
};

#endif
