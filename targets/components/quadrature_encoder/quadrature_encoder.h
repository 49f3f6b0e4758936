/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A quadrature encoder as an angle: counts accumulated into 64 bits, scaled, with a reset that loses no counts.
 *
 * Needs only the port layer.  Not thread-safe: all calls from one context.
 */
#ifndef EPG_QUADRATURE_ENCODER_H
#define EPG_QUADRATURE_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/fault.h"
#include "epg/finite.h"
#include "epg/port.h"

typedef struct epg_quadrature_encoder_config {
    epg_port_quadrature_t decoder;
    double rad_per_count; /**< at the load, after x4; negative: counts fall as the angle rises */
    double preset;        /**< rad; the position that a reset loads */
} epg_quadrature_encoder_config_t;

/** State of one encoder; set by epg_quadrature_encoder_start(). */
typedef struct epg_quadrature_encoder {
    double position;     /**< rad at the load, as sampled last */
    double origin;       /**< rad at `counts` = 0: 0 until the first reset, `preset` after it */
    int64_t counts;      /**< since the start or the last reset */
    uint32_t last_count; /**< of the decoder, modulo 2^32 */
    uint32_t resets;     /**< so far, modulo 2^32: at each of them the position jumped */
    bool reset_level;    /**< of the reset signal, for its edge */
} epg_quadrature_encoder_t;

/** Starts the decoder; the position is 0 where the shaft stands, as an incremental encoder does not know better. */
static inline void epg_quadrature_encoder_start(epg_quadrature_encoder_t *encoder,
                                                const epg_quadrature_encoder_config_t *config)
{
    epg_port_quadrature_start(&config->decoder);
    *encoder = (epg_quadrature_encoder_t){.last_count = epg_port_quadrature_count(&config->decoder)};
}

/** Updates `position`.  Once per control cycle: between two calls fewer than 2^31 counts may pass. */
static inline void epg_quadrature_encoder_sample(epg_quadrature_encoder_t *encoder,
                                                 const epg_quadrature_encoder_config_t *config)
{
    const uint32_t count = epg_port_quadrature_count(&config->decoder);
    /* The difference modulo 2^32, taken as signed (two's complement, as on every compiler supported). */
    encoder->counts += (int32_t)(count - encoder->last_count);
    encoder->last_count = count;
    encoder->position = encoder->origin + (double)encoder->counts * config->rad_per_count;
}

/**
 * The reset signal: its rising edge through 0.5 makes the angle sampled last `preset`.  The decoder counts on, so
 * counts since that sample are kept, and `position` follows with the next sample.
 */
static inline void epg_quadrature_encoder_reset(epg_quadrature_encoder_t *encoder,
                                                const epg_quadrature_encoder_config_t *config, double signal)
{
    const bool level = signal > 0.5;
    if (level && !encoder->reset_level) {
        encoder->counts = 0;
        encoder->origin = config->preset;
        encoder->resets++;
    }
    encoder->reset_level = level;
}

/** EPG_FAULT_SENSOR when the decoder has stopped: then the position stands still, and is wrong. */
static inline epg_fault_t epg_quadrature_encoder_check(const epg_quadrature_encoder_config_t *config)
{
    return epg_port_quadrature_healthy(&config->decoder) ? EPG_FAULT_NONE : EPG_FAULT_SENSOR;
}

/** While disabled: resets are withheld, and the first high signal afterwards is an edge. */
static inline void epg_quadrature_encoder_withhold_reset(epg_quadrature_encoder_t *encoder)
{
    encoder->reset_level = false;
}

/**
 * The inverse, for simulation: count of the edges passed at `angle` (rad at the load), rounded down.  An angle that
 * is not finite gives 0, one beyond +-2^62 counts the nearest of these.
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
    int64_t count = (int64_t)edges; /* towards zero */
    if ((double)count > edges) {
        count--;
    }
    return rad_per_count < 0.0 ? -count : count;
}

#endif
