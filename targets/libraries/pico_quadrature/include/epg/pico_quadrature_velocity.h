/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Velocity from the times of edges, for encoders of the variant EPG_PICO_QUADRATURE_VELOCITY.
 *
 * At low speed, the number of edges in a fixed time is only 0 or 1, which is a poor estimate of the velocity.  This
 * module uses the last edge before each of two reads.  It divides the counts between these two edges by the time
 * between them, which the state machine measures with a resolution of 9 cycles of clk_sys.
 *
 * While there is no new edge, the estimate is limited to one count in the time since the last edge.  After `timeout_ns`
 * it is 0.
 *
 * Two reads must be at most 65535 x 9 cycles apart (4.7 ms at 125 MHz).  After a longer pause, the estimate is the
 * number of counts divided by the length of the pause.
 */
#ifndef EPG_PICO_QUADRATURE_VELOCITY_H
#define EPG_PICO_QUADRATURE_VELOCITY_H

#include "epg/pico_quadrature.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The state of an estimate; epg_pico_quadrature_velocity_init() sets it. */
typedef struct epg_pico_quadrature_velocity {
    double velocity; /**< counts/s */
    double cycle_ns; /**< period of clk_sys */
    uint64_t timeout_ns;
    uint64_t read_ns;   /**< time of the last read */
    uint64_t edge_ns;   /**< time of the last known edge */
    int64_t edge_twice; /**< twice the position of that edge, which is halfway between two counts */
    bool edge_known;
} epg_pico_quadrature_velocity_t;

/** Starts with velocity 0.  `now_ns` is the time of any clock of the caller.  clk_sys must not change afterwards. */
void epg_pico_quadrature_velocity_init(epg_pico_quadrature_velocity_t *estimate, uint64_t now_ns, uint64_t timeout_ns);

/**
 * Reads the position and updates `estimate->velocity`.  `now_ns` is the time of the call.  Its error divided by the
 * time between two reads is the relative error of the estimate.  If the result is EPG_PICO_QUADRATURE_ERROR_HALTED, the
 * estimate does not change.
 */
epg_pico_quadrature_error_t epg_pico_quadrature_velocity_read(epg_pico_quadrature_velocity_t *estimate,
                                                              epg_pico_quadrature_t *encoder, uint64_t now_ns,
                                                              int64_t *position);

#ifdef __cplusplus
}
#endif

#endif
