/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The PIO programs of src/pico_quadrature.pio as instruction words.  This header does not need an SDK, so any driver
 * can use it.
 *
 * A program must be loaded at address 0, once per PIO block.  Each state machine must have these settings:
 * - The IN base is the lower of the two pins.  IN shifts left, OUT shifts right, without autopush and autopull.  The
 *   clock divider is 1.
 * - The program wraps from `..._WRAP` to `..._WRAP_TARGET`.  Its first instruction is `..._START`.
 * - Y is 0, and OSR holds the present levels of the pins (bit 0: the lower pin).  The driver sets both by instructions
 *   that it executes before it enables the state machine.
 *
 * If A is the lower pin and B the upper one, the count rises when A leads B.
 */
#ifndef EPG_PICO_QUADRATURE_PROGRAM_H
#define EPG_PICO_QUADRATURE_PROGRAM_H

#include <stdint.h>

#define EPG_PICO_QUADRATURE_ORIGIN 0u

/** State machine n (0 ... 3) raises the PIO flag with this number plus n when both pins change at once. */
#define EPG_PICO_QUADRATURE_SKIPPED_FLAG 4u

/** The program `count` pushes the count modulo 2^32. */
#define EPG_PICO_QUADRATURE_COUNT_LENGTH 28u
#define EPG_PICO_QUADRATURE_COUNT_START 19u
#define EPG_PICO_QUADRATURE_COUNT_WRAP_TARGET 19u
#define EPG_PICO_QUADRATURE_COUNT_WRAP 27u
/** Shortest distance in cycles between two edges that are counted exactly.  It is one more than the program needs,
 * because the synchroniser of a pin can delay one of the two edges by a cycle. */
#define EPG_PICO_QUADRATURE_COUNT_EDGE_CYCLES 10u
/** Longest time in cycles between two pushes while edges have at least that distance. */
#define EPG_PICO_QUADRATURE_COUNT_SILENCE_CYCLES 90u

static const uint16_t epg_pico_quadrature_count_program[EPG_PICO_QUADRATURE_COUNT_LENGTH] = {
    0x0011, 0x0019, 0x0010, 0x0017, 0x0010, 0x0011, 0x0017, 0x0019, 0x0019, 0x0017, 0x0011, 0x0010, 0x0017, 0x0010,
    0x0019, 0x0011, 0x0093, 0xa0c2, 0x8000, 0x60c2, 0x4002, 0xa0e6, 0xa0a6, 0xc014, 0x0011, 0xa04a, 0x009b, 0xa04a,
};

/**
 * The program `velocity` pushes words of two halves.  The upper half is the count modulo 2^16.  The lower half is the
 * complement of the number of samples without a change since the last edge, modulo 2^16.
 */
#define EPG_PICO_QUADRATURE_VELOCITY_LENGTH 32u
#define EPG_PICO_QUADRATURE_VELOCITY_START 22u
#define EPG_PICO_QUADRATURE_VELOCITY_WRAP_TARGET 22u
#define EPG_PICO_QUADRATURE_VELOCITY_WRAP 31u
#define EPG_PICO_QUADRATURE_VELOCITY_EDGE_CYCLES 12u
#define EPG_PICO_QUADRATURE_VELOCITY_SILENCE_CYCLES 70u
/** Cycles of a sample without a change, and mean number of cycles from an edge to the first push after it. */
#define EPG_PICO_QUADRATURE_VELOCITY_SAMPLE_CYCLES 9u
#define EPG_PICO_QUADRATURE_VELOCITY_LATENCY_CYCLES 22u

static const uint16_t epg_pico_quadrature_velocity_program[EPG_PICO_QUADRATURE_VELOCITY_LENGTH] = {
    0x0012, 0x001c, 0x0010, 0x001a, 0x0010, 0x0012, 0x001a, 0x001c, 0x001c, 0x001a, 0x0012,
    0x0010, 0x001a, 0x0010, 0x001c, 0x0012, 0xa02b, 0x0096, 0x0053, 0x4050, 0x4030, 0x8000,
    0x60c2, 0x4002, 0xa0e6, 0xa0a6, 0xc014, 0x0012, 0xa02b, 0xa04a, 0x009f, 0xa04a,
};

#endif
