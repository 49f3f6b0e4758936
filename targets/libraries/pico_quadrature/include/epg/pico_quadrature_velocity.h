/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Velocity from the times of edges, for encoders of the variant EPG_PICO_QUADRATURE_VELOCITY.
 *
 * Counting edges in a fixed time gives nothing but 0 and 1 at low speed.  Here the way between the last edges of two
 * reads is divided by the time between those edges, which the state machine measures to 9 cycles of clk_sys.  Without
 * new edges the estimate falls as fast as the missing edge allows, and is 0 after `timeout_ns`.
 *
 * Reads may be at most 65535 x 9 cycles apart (4.7 ms at 125 MHz) for that; after a longer pause the estimate is counts
 * per time.
 */
#ifndef EPG_PICO_QUADRATURE_VELOCITY_H
#define EPG_PICO_QUADRATURE_VELOCITY_H

#include "epg/pico_quadrature.h"

#ifdef __cplusplus
extern "C" {
#endif

/** State of the estimate; set by epg_pico_quadrature_velocity_init(). */
typedef struct epg_pico_quadrature_velocity {
    double velocity; /**< counts/s */
    double cycle_ns; /**< of clk_sys */
    uint64_t timeout_ns;
    uint64_t read_ns;   /**< of the last read */
    uint64_t edge_ns;   /**< of the last edge known */
    int64_t edge_twice; /**< twice the way travelled to that edge, which lies between two counts */
    bool edge_known;
} epg_pico_quadrature_velocity_t;

/** Begins at standstill at `now_ns`, of a clock of the caller's choice.  clk_sys must not change afterwards. */
void epg_pico_quadrature_velocity_init(epg_pico_quadrature_velocity_t *estimate, uint64_t now_ns, uint64_t timeout_ns);

/**
 * Reads the position and updates `estimate->velocity`; `now_ns` is the time of the call.  An error of that time goes
 * into the estimate as its ratio to the time between reads.  On EPG_PICO_QUADRATURE_ERROR_HALTED nothing changes.
 */
epg_pico_quadrature_error_t epg_pico_quadrature_velocity_read(epg_pico_quadrature_velocity_t *estimate,
                                                              epg_pico_quadrature_t *encoder, uint64_t now_ns,
                                                              int64_t *position);

#ifdef __cplusplus
}
#endif

#endif
