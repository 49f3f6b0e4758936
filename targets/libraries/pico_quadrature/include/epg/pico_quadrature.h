/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Quadrature encoders on the PIO of RP2040 and RP2350: four per PIO block, with 64-bit positions.
 *
 * A quadrature encoder has two outputs, A and B.  Both are square waves, a quarter of a period apart, so the order of
 * their edges is the direction of the movement.
 *
 * PIO (programmable input/output) is a part of these chips that can decode such signals without the processor.  Each
 * PIO block has four *state machines* and one instruction memory of 32 words, which they share.  Each state machine
 * runs a small program with its own registers and passes its results to the processor through a FIFO.  An encoder takes
 * one state machine and two adjacent pins, in either order.
 *
 *     static const epg_pico_quadrature_config_t config = {.pin_a = 10, .pin_b = 11, .block = 0};
 *     static epg_pico_quadrature_t encoder;
 *
 *     if (epg_pico_quadrature_init(&encoder, &config) != EPG_PICO_QUADRATURE_OK) { ... }
 *     for (;;) {
 *         int64_t position;
 *         if (epg_pico_quadrature_read(&encoder, &position) == EPG_PICO_QUADRATURE_OK) { ... }
 *     }
 *
 * Every edge of A and B counts (x4), and the position rises when A leads B.  The processor has no work between two
 * reads, and a read takes a bounded number of cycles.
 *
 * The program `count` counts edges that are at least 10 cycles of clk_sys apart (12.5 million edges/s at 125 MHz), the
 * program `velocity` edges that are at least 12 cycles apart (src/pico_quadrature.pio).  Faster edges are lost.  If
 * both pins have changed between two samples of the program, the loss is detected and counted in `skipped`.
 *
 * The functions of one encoder must be called from one context (core and priority) at a time.  The same holds for init
 * and stop of all encoders together.
 */
#ifndef EPG_PICO_QUADRATURE_H
#define EPG_PICO_QUADRATURE_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/pico_quadrature_program.h"
#include "hardware/pio.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The results of the functions. */
typedef enum epg_pico_quadrature_error {
    EPG_PICO_QUADRATURE_OK = 0,
    EPG_PICO_QUADRATURE_ERROR_PINS,               /**< A and B are not adjacent, or the block cannot reach them */
    EPG_PICO_QUADRATURE_ERROR_PIN_IN_USE,         /**< a pin has another function, or is an output */
    EPG_PICO_QUADRATURE_ERROR_PULL,               /**< pull-down on RP2350 (erratum RP2350-E9) */
    EPG_PICO_QUADRATURE_ERROR_BLOCK,              /**< the chip does not have this PIO block */
    EPG_PICO_QUADRATURE_ERROR_STATE_MACHINE,      /**< no such state machine, or it is claimed, or none is free */
    EPG_PICO_QUADRATURE_ERROR_INSTRUCTION_MEMORY, /**< the block has another program, or the other variant */
    EPG_PICO_QUADRATURE_ERROR_HALTED              /**< the state machine does not run, so no position was read */
} epg_pico_quadrature_error_t;

/** The PIO program.  All encoders of one block must use the same one. */
typedef enum epg_pico_quadrature_variant {
    EPG_PICO_QUADRATURE_COUNT,   /**< gives positions */
    EPG_PICO_QUADRATURE_VELOCITY /**< also gives the time since the last edge: epg/pico_quadrature_velocity.h */
} epg_pico_quadrature_variant_t;

/**
 * The pull resistors of both pins.
 *
 * RP2350 supports only NONE and UP.  While an input is enabled, its pad leaks so much current that the pull-down cannot
 * make a released pin low (erratum RP2350-E9).  For the same reason, a pin of RP2350 without pull-up must be driven by
 * a push-pull output, or have an external resistor of at most 8.2 kOhm.
 */
typedef enum epg_pico_quadrature_pull {
    EPG_PICO_QUADRATURE_PULL_NONE,
    EPG_PICO_QUADRATURE_PULL_UP,
    EPG_PICO_QUADRATURE_PULL_DOWN
} epg_pico_quadrature_pull_t;

/** The value of `state_machine` for any free one. */
#define EPG_PICO_QUADRATURE_ANY 0xffu

/** The configuration of one encoder. */
typedef struct epg_pico_quadrature_config {
    uint8_t pin_a;
    uint8_t pin_b;
    uint8_t block;         /**< PIO block: 0, 1, and 2 on RP2350 */
    uint8_t state_machine; /**< 0 ... 3, or EPG_PICO_QUADRATURE_ANY */
    epg_pico_quadrature_variant_t variant;
    epg_pico_quadrature_pull_t pull;
    bool invert; /**< true: the position falls when A leads B */
} epg_pico_quadrature_config_t;

/** The state of one encoder; epg_pico_quadrature_init() or epg_pico_quadrature_attach() sets it. */
typedef struct epg_pico_quadrature {
    PIO pio;
    uint8_t state_machine;
    uint8_t pin; /**< the lower of the two pins */
    epg_pico_quadrature_variant_t variant;
    bool reversed;     /**< the position falls when the count of the state machine rises */
    uint32_t last;     /**< word of the last read */
    int64_t travelled; /**< counts from the start to the last read */
    int64_t offset;    /**< position at which `travelled` is 0 */
    uint32_t skipped;  /**< reads after both pins changed at once: edges too fast, noise, or a broken wire */
} epg_pico_quadrature_t;

/**
 * Number of polls for a new count, after which the state machine counts as halted.  They last longer than its silence.
 */
#define EPG_PICO_QUADRATURE_POLLS 32u

/**
 * Claims the state machine, loads the program if the block does not have it yet, and starts to count at 0.  After an
 * error nothing is claimed.
 */
epg_pico_quadrature_error_t epg_pico_quadrature_init(epg_pico_quadrature_t *encoder,
                                                     const epg_pico_quadrature_config_t *config);

/**
 * As epg_pico_quadrature_init(), but neither claims a state machine nor loads a program.  The caller must have claimed
 * `state_machine`, which must not be EPG_PICO_QUADRATURE_ANY, and loaded the variant's program at address 0.
 */
epg_pico_quadrature_error_t epg_pico_quadrature_attach(epg_pico_quadrature_t *encoder,
                                                       const epg_pico_quadrature_config_t *config);

/** Stops the state machine, and releases everything that epg_pico_quadrature_init() has claimed. */
void epg_pico_quadrature_stop(epg_pico_quadrature_t *encoder);

/** Returns a text that describes `error`. */
const char *epg_pico_quadrature_error_text(epg_pico_quadrature_error_t error);

/**
 * Gives the newest word of the state machine, which is not older than the call.  With the program `count`, the word is
 * the count modulo 2^32; `invert` and the order of the pins do not affect it.  Returns false if the state machine is
 * halted.
 *
 * Takes at most 5 + EPG_PICO_QUADRATURE_POLLS reads of PIO registers.  It is inline, so that its code is in the same
 * memory (flash or RAM) as the caller's.
 */
static inline bool epg_pico_quadrature_newest(const epg_pico_quadrature_t *encoder, uint32_t *word)
{
    const uint32_t machine = encoder->state_machine;
    const uint32_t empty = 1u << (PIO_FSTAT_RXEMPTY_LSB + machine);
    /* The words in the FIFO are old: they were pushed after the last read, until the FIFO was full. */
    uint32_t stale = encoder->pio->flevel >> (8u * machine + PIO_FLEVEL_RX0_LSB) & 0xfu;
    for (; stale > 0; stale--) {
        (void)encoder->pio->rxf[machine];
    }
    for (uint32_t poll = 0; poll < EPG_PICO_QUADRATURE_POLLS; poll++) {
        if ((encoder->pio->fstat & empty) == 0) {
            *word = encoder->pio->rxf[machine];
            return true;
        }
    }
    return false;
}

/** Returns true once after both pins have changed at once. */
static inline bool epg_pico_quadrature_take_skipped(const epg_pico_quadrature_t *encoder)
{
    const uint32_t flag = 1u << (EPG_PICO_QUADRATURE_SKIPPED_FLAG + encoder->state_machine);
    if ((encoder->pio->irq & flag) == 0) {
        return false;
    }
    encoder->pio->irq = flag; /* write 1 to clear */
    return true;
}

/** Adds the counts from the last word to `word` to `travelled`.  The functions that read the position use it. */
static inline void epg_pico_quadrature_follow(epg_pico_quadrature_t *encoder, uint32_t word)
{
    int32_t moved = 0;
    if (encoder->variant == EPG_PICO_QUADRATURE_COUNT) {
        moved = (int32_t)(word - encoder->last);
    } else { /* the count has 16 bits */
        moved = (int16_t)(uint16_t)((word >> 16) - (encoder->last >> 16));
    }
    encoder->last = word;
    encoder->travelled += encoder->reversed ? -(int64_t)moved : (int64_t)moved;
    if (epg_pico_quadrature_take_skipped(encoder)) {
        encoder->skipped++;
    }
}

/**
 * Reads the present position in counts.  Fewer than 2^31 counts (2^15 with the program `velocity`) may pass between two
 * reads; at 12.5 million edges/s this is 171 s (2.6 ms).  If the result is EPG_PICO_QUADRATURE_ERROR_HALTED,
 * `*position` is the last known one.
 */
static inline epg_pico_quadrature_error_t epg_pico_quadrature_read(epg_pico_quadrature_t *encoder, int64_t *position)
{
    uint32_t word;
    const bool alive = epg_pico_quadrature_newest(encoder, &word);
    if (alive) {
        epg_pico_quadrature_follow(encoder, word);
    }
    *position = encoder->travelled + encoder->offset;
    return alive ? EPG_PICO_QUADRATURE_OK : EPG_PICO_QUADRATURE_ERROR_HALTED;
}

/**
 * Makes the position that was read last equal to `position`.  The state machine continues to count, so the counts since
 * that read are not lost; they are part of the next position.
 */
static inline void epg_pico_quadrature_preset(epg_pico_quadrature_t *encoder, int64_t position)
{
    encoder->offset = position - encoder->travelled;
}

#ifdef __cplusplus
}
#endif

#endif
