/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Velocity from the times of edges.  See epg/pico_quadrature_velocity.h.
 */
#include "epg/pico_quadrature_velocity.h"

#include "hardware/clocks.h"
#include "pico/platform.h"

#define LONGEST_AGE 0xffffu /* samples */

void epg_pico_quadrature_velocity_init(epg_pico_quadrature_velocity_t *estimate, uint64_t now_ns, uint64_t timeout_ns)
{
    *estimate = (epg_pico_quadrature_velocity_t){
        .cycle_ns = 1e9 / (double)clock_get_hz(clk_sys),
        .timeout_ns = timeout_ns,
        .read_ns = now_ns,
    };
}

/** Returns the time since the last edge.  `word` contains the complement of the number of samples since then. */
static double __not_in_flash_func(edge_age_ns)(const epg_pico_quadrature_velocity_t *estimate, uint32_t word)
{
    const uint32_t samples = ~word & LONGEST_AGE;
    const uint32_t cycles = samples * EPG_PICO_QUADRATURE_VELOCITY_SAMPLE_CYCLES +
                            (EPG_PICO_QUADRATURE_VELOCITY_LATENCY_CYCLES - EPG_PICO_QUADRATURE_VELOCITY_SAMPLE_CYCLES);
    return (double)cycles * estimate->cycle_ns;
}

/** Limits the estimate while there is no new edge: the speed is at most one count in the time since the last edge. */
static void __not_in_flash_func(let_fall)(epg_pico_quadrature_velocity_t *estimate, uint64_t now_ns)
{
    const uint64_t since = now_ns - estimate->edge_ns;
    if (!estimate->edge_known || since >= estimate->timeout_ns) {
        estimate->velocity = 0.0;
        estimate->edge_known = false; /* the time from this old edge to the next one is not a measure of the speed */
        return;
    }
    const double limit = 1e9 / (double)since;
    if (estimate->velocity > limit) {
        estimate->velocity = limit;
    } else if (estimate->velocity < -limit) {
        estimate->velocity = -limit;
    }
}

epg_pico_quadrature_error_t __not_in_flash_func(epg_pico_quadrature_velocity_read)(
    epg_pico_quadrature_velocity_t *estimate, epg_pico_quadrature_t *encoder, uint64_t now_ns, int64_t *position)
{
    uint32_t word;
    const int64_t before = encoder->travelled;
    if (!epg_pico_quadrature_newest(encoder, &word)) {
        *position = before + encoder->offset;
        return EPG_PICO_QUADRATURE_ERROR_HALTED;
    }
    epg_pico_quadrature_follow(encoder, word);
    *position = encoder->travelled + encoder->offset;
    const int64_t moved = encoder->travelled - before;
    if (moved == 0) {
        let_fall(estimate, now_ns);
        estimate->read_ns = now_ns;
        return EPG_PICO_QUADRATURE_OK;
    }
    const double pause = (double)(now_ns - estimate->read_ns);
    const double age = edge_age_ns(estimate, word);
    const double longest = (double)(LONGEST_AGE * EPG_PICO_QUADRATURE_VELOCITY_SAMPLE_CYCLES) * estimate->cycle_ns;
    const bool age_known = pause < longest;
    const uint64_t edge_ns = now_ns - (age_known && age < pause ? (uint64_t)age : 0u);
    /* The position of an edge is halfway between the counts before and after it. */
    const int64_t edge_twice = 2 * encoder->travelled - (moved > 0 ? 1 : -1);
    if (!age_known) {
        estimate->velocity = (double)moved * 1e9 / pause;
    } else if (estimate->edge_known && edge_ns > estimate->edge_ns) {
        estimate->velocity =
            0.5e9 * (double)(edge_twice - estimate->edge_twice) / (double)(edge_ns - estimate->edge_ns);
    }
    estimate->edge_ns = edge_ns;
    estimate->edge_twice = edge_twice;
    estimate->edge_known = true;
    estimate->read_ns = now_ns;
    return EPG_PICO_QUADRATURE_OK;
}
