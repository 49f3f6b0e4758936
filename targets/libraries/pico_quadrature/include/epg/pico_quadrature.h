/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Quadrature encoders on the PIO of RP2040 and RP2350: four per PIO block, with 64-bit positions.
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
 * Every edge of A and B counts (x4); the position rises when A leads B.  A decoder needs no processor time between
 * reads, and a read takes a bounded number of cycles.  The lower pin may be A or B; they must be neighbours.
 *
 * Rates (src/pico_quadrature.pio): program `count` counts edges that are at least 10 cycles of clk_sys apart
 * (12.5 million edges/s at 125 MHz), program `velocity` 12 cycles.  Edges that come faster are lost; where both pins
 * changed between two samples, that is noticed (`skipped`).
 *
 * All functions of one encoder are for one context (core and priority) at a time; init and stop of all encoders too.
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

typedef enum epg_pico_quadrature_error {
    EPG_PICO_QUADRATURE_OK = 0,
    EPG_PICO_QUADRATURE_ERROR_PINS,               /**< A and B are no neighbours, or out of the block's reach */
    EPG_PICO_QUADRATURE_ERROR_PIN_IN_USE,         /**< a pin has another function, or is an output */
    EPG_PICO_QUADRATURE_ERROR_PULL,               /**< pull-down on RP2350 (erratum RP2350-E9) */
    EPG_PICO_QUADRATURE_ERROR_BLOCK,              /**< the chip has no such PIO block */
    EPG_PICO_QUADRATURE_ERROR_STATE_MACHINE,      /**< no such state machine, or it is claimed, or none is left */
    EPG_PICO_QUADRATURE_ERROR_INSTRUCTION_MEMORY, /**< the block has another program (or the other variant) */
    EPG_PICO_QUADRATURE_ERROR_HALTED              /**< the state machine does not run: nothing was read */
} epg_pico_quadrature_error_t;

/** The PIO program; one block has one. */
typedef enum epg_pico_quadrature_variant {
    EPG_PICO_QUADRATURE_COUNT,   /**< positions */
    EPG_PICO_QUADRATURE_VELOCITY /**< positions and the time since the last edge: epg/pico_quadrature_velocity.h */
} epg_pico_quadrature_variant_t;

/**
 * On RP2350 only NONE and UP: with the input enabled, its pads leak so much that the pull-down cannot bring a released
 * pin low (erratum RP2350-E9).  For the same reason, what drives a pin there without pull-up must be push-pull, or have
 * an external resistor of at most 8.2 kOhm.
 */
typedef enum epg_pico_quadrature_pull {
    EPG_PICO_QUADRATURE_PULL_NONE,
    EPG_PICO_QUADRATURE_PULL_UP,
    EPG_PICO_QUADRATURE_PULL_DOWN
} epg_pico_quadrature_pull_t;

/** For `state_machine`: any that is free. */
#define EPG_PICO_QUADRATURE_ANY 0xffu

typedef struct epg_pico_quadrature_config {
    uint8_t pin_a;
    uint8_t pin_b;
    uint8_t block;         /**< PIO block: 0, 1, and 2 on RP2350 */
    uint8_t state_machine; /**< 0 ... 3, or EPG_PICO_QUADRATURE_ANY */
    epg_pico_quadrature_variant_t variant;
    epg_pico_quadrature_pull_t pull;
    bool invert; /**< the position falls when A leads */
} epg_pico_quadrature_config_t;

/** State of one encoder; set by epg_pico_quadrature_init(). */
typedef struct epg_pico_quadrature {
    PIO pio;
    uint8_t state_machine;
    uint8_t pin; /**< the lower one */
    epg_pico_quadrature_variant_t variant;
    bool reversed;     /**< the position runs against the state machine's count */
    uint32_t last;     /**< word read last */
    int64_t travelled; /**< counts from the start to the last read */
    int64_t offset;    /**< position where `travelled` is 0 */
    uint32_t skipped;  /**< reads before which both pins had changed at once: edges too fast, noise, or a broken wire */
} epg_pico_quadrature_t;

/** Registers are asked so often for a new count before the state machine counts as halted: more than its silence. */
#define EPG_PICO_QUADRATURE_POLLS 32u

/**
 * Claims the state machine, loads the program if the block does not have it yet, and starts to count at 0.  On an error
 * nothing is left claimed.
 */
epg_pico_quadrature_error_t epg_pico_quadrature_init(epg_pico_quadrature_t *encoder,
                                                     const epg_pico_quadrature_config_t *config);

/**
 * The same for a state machine that the caller has claimed, in a block into which the caller has loaded the variant's
 * program at address 0.  `state_machine` must be given.  Neither claims nor loads.
 */
epg_pico_quadrature_error_t epg_pico_quadrature_attach(epg_pico_quadrature_t *encoder,
                                                       const epg_pico_quadrature_config_t *config);

/** Stops the state machine, and gives back what epg_pico_quadrature_init() has taken. */
void epg_pico_quadrature_stop(epg_pico_quadrature_t *encoder);

/** What an error is, in words. */
const char *epg_pico_quadrature_error_text(epg_pico_quadrature_error_t error);

/**
 * The newest word of the state machine: program `count`'s is the count modulo 2^32, which neither `invert` nor the order
 * of the pins changes.  Not older than the call.  False if the state machine is halted.
 *
 * Takes at most 5 + EPG_PICO_QUADRATURE_POLLS reads of PIO registers; inline, so that it runs from where its caller does.
 */
static inline bool epg_pico_quadrature_newest(const epg_pico_quadrature_t *encoder, uint32_t *word)
{
    const uint32_t machine = encoder->state_machine;
    const uint32_t empty = 1u << (PIO_FSTAT_RXEMPTY_LSB + machine);
    /* What stands in the FIFO was pushed some time after the last read, and nothing after it was full. */
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

/** True once after both pins have changed at once. */
static inline bool epg_pico_quadrature_take_skipped(const epg_pico_quadrature_t *encoder)
{
    const uint32_t flag = 1u << (EPG_PICO_QUADRATURE_SKIPPED_FLAG + encoder->state_machine);
    if ((encoder->pio->irq & flag) == 0) {
        return false;
    }
    encoder->pio->irq = flag; /* write 1 to clear */
    return true;
}

/** Adds the way from the last word to `word` to `travelled`.  Used by the reads. */
static inline void epg_pico_quadrature_follow(epg_pico_quadrature_t *encoder, uint32_t word)
{
    int32_t moved = 0;
    if (encoder->variant == EPG_PICO_QUADRATURE_COUNT) {
        moved = (int32_t)(word - encoder->last);
    } else { /* 16 bits of count */
        moved = (int16_t)(uint16_t)((word >> 16) - (encoder->last >> 16));
    }
    encoder->last = word;
    encoder->travelled += encoder->reversed ? -(int64_t)moved : (int64_t)moved;
    if (epg_pico_quadrature_take_skipped(encoder)) {
        encoder->skipped++;
    }
}

/**
 * The position now, in counts.  Between two reads fewer than 2^31 counts may pass (2^15 with the program `velocity`):
 * at 12.5 million edges/s, 171 s (2.6 ms).  On EPG_PICO_QUADRATURE_ERROR_HALTED `*position` is the last one known.
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
 * Makes the position read last `position`.  The state machine is not touched: counts since that read are kept, and show
 * with the next.
 */
static inline void epg_pico_quadrature_preset(epg_pico_quadrature_t *encoder, int64_t position)
{
    encoder->offset = position - encoder->travelled;
}

#ifdef __cplusplus
}
#endif

#endif
