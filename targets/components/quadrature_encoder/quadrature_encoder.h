/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An incremental (quadrature) encoder as an angle in rad at the load.
 *
 * The encoder has two outputs, A and B, that are square waves a quarter of a period apart.  A decoder counts every edge
 * of both (x4), upwards in one direction and downwards in the other.  Its count has 32 bits and wraps; this driver
 * accumulates the differences into 64 bits and scales them.
 *
 * An incremental encoder does not know its absolute angle.  The angle is 0 at the start.  A reset signal, for example
 * from an end switch during homing, sets it to a known value; the counts during the reset are not lost.
 *
 * Needs only the port layer.  Not thread-safe: all calls must come from one context.
 */
#ifndef EPG_QUADRATURE_ENCODER_H
#define EPG_QUADRATURE_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/fault.h"
#include "epg/finite.h"
#include "epg/port.h"
#include "epg/soft_double.h"

typedef struct epg_quadrature_encoder_config {
    epg_port_quadrature_t decoder;
    double rad_per_count;    /**< at the load, for one count (x4); negative: counts fall as the angle rises */
    double preset;           /**< rad; the position after a reset */
    uint64_t longest_gap_ns; /**< time in which the counter moves by half of its range, by `max_speed`; 0: unknown */
} epg_quadrature_encoder_config_t;

/** The state of one encoder; epg_quadrature_encoder_start() sets it. */
typedef struct epg_quadrature_encoder {
    double position;     /**< rad at the load, as sampled last */
    double origin;       /**< rad at `counts` = 0: 0 before the first reset, then `preset` */
    int64_t counts;      /**< counts since the start or the last reset */
    uint32_t last_count; /**< count of the decoder at the last sample, modulo 2^32 */
    uint64_t sampled_ns; /**< time of the newest sample; 0: none yet */
    uint32_t resets;     /**< number of resets, modulo 2^32; at each of them the position can jump */
    bool reset_level;    /**< last level of the reset signal, to find its edge */
} epg_quadrature_encoder_t;

/** Starts the decoder.  The present position of the shaft becomes 0. */
static inline void epg_quadrature_encoder_start(epg_quadrature_encoder_t *encoder,
                                                const epg_quadrature_encoder_config_t *config)
{
    epg_port_quadrature_start(&config->decoder);
    *encoder = (epg_quadrature_encoder_t){.last_count = epg_port_quadrature_count(&config->decoder)};
}

/**
 * Updates `position`.  Must be called once per control cycle, and before 2^31 counts have passed since the last call.
 */
static inline void epg_quadrature_encoder_sample(epg_quadrature_encoder_t *encoder,
                                                 const epg_quadrature_encoder_config_t *config)
{
    const uint32_t count = epg_port_quadrature_count(&config->decoder);
    /* The difference modulo 2^32 as a signed number (two's complement, as with every supported compiler). */
    encoder->counts += (int32_t)(count - encoder->last_count);
    encoder->last_count = count;
    encoder->position = epg_scaled(encoder->counts, config->rad_per_count, encoder->origin);
}

/**
 * Takes the reset signal, which must not be NaN.  When it rises above 0.5, the angle that was sampled last becomes `preset`.  The decoder
 * continues to count, so the counts since that sample are not lost.  `position` changes with the next sample.
 */
static inline void epg_quadrature_encoder_reset(epg_quadrature_encoder_t *encoder,
                                                const epg_quadrature_encoder_config_t *config, double signal)
{
    const bool level = epg_less(0.5, signal);
    if (level && !encoder->reset_level) {
        encoder->counts = 0;
        encoder->origin = config->preset;
        encoder->resets++;
    }
    encoder->reset_level = level;
}

/** Returns false if the decoder has stopped: the position is wrong then. */
static inline bool epg_quadrature_encoder_healthy(const epg_quadrature_encoder_config_t *config)
{
    return epg_port_quadrature_healthy(&config->decoder);
}

/**
 * Takes the time of the newest sample, `now_ns`.  Returns false if so much time has passed since the sample before that
 * the counter can have moved by half of its range: counts can be lost then, and the position can be wrong until the next
 * reset.  Must be called once per control cycle, if `longest_gap_ns` is not 0.
 */
static inline bool epg_quadrature_encoder_followed(epg_quadrature_encoder_t *encoder,
                                                   const epg_quadrature_encoder_config_t *config, uint64_t now_ns)
{
    const uint64_t before_ns = encoder->sampled_ns;
    encoder->sampled_ns = now_ns;
    return before_ns == 0U || now_ns - before_ns < config->longest_gap_ns;
}

/** Ignores the reset signal while the target is disabled.  A signal that is high afterwards counts as an edge. */
static inline void epg_quadrature_encoder_withhold_reset(epg_quadrature_encoder_t *encoder)
{
    encoder->reset_level = false;
}

/**
 * Returns the count at `angle` (rad at the load), rounded down.  This inverse is for simulation.  An angle that is not
 * finite gives 0; the result is limited to +-2^62 counts.
 */
static inline int64_t epg_quadrature_encoder_count_at(double angle, double rad_per_count)
{
    const double limit = 4611686018427387904.0;
    const double size = rad_per_count < 0.0 ? -rad_per_count : rad_per_count;
    double edges = angle / size;
    if (!epg_is_finite(angle)) {
        return 0;
    }
    edges = edges > limit ? limit : edges < -limit ? -limit : edges;
    int64_t count = (int64_t)edges; /* rounds towards zero */
    if ((double)count > edges) {
        count--;
    }
    return rad_per_count < 0.0 ? -count : count;
}

#endif
