/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Quadrature decoders: state machines of the PIO that run the program of the library pico_quadrature.
 */
#include "encoder_sdk.h"
#include "epg/port.h"
#include "parts.h"

#define STATE_MACHINES 4U

typedef struct decoder {
    epg_pico_quadrature_t encoder;
    bool started;
    bool healthy;   /* its state machine delivered a count at the last reading */
    uint32_t count; /* the newest count */
} decoder_t;

static decoder_t decoders[NUM_PIOS][STATE_MACHINES];

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    decoder_t *state = &decoders[decoder->instance][decoder->slot];
    const epg_pico_quadrature_config_t config = {
        .pin_a = decoder->pin_a,
        .pin_b = decoder->pin_b,
        .block = decoder->instance,
        .state_machine = decoder->slot,
        .variant = EPG_PICO_QUADRATURE_COUNT,
        .pull = decoder->pull_up ? EPG_PICO_QUADRATURE_PULL_UP : EPG_PICO_QUADRATURE_PULL_NONE,
    };
    state->count = 0;
    state->started = epg_pico_quadrature_init(&state->encoder, &config) == EPG_PICO_QUADRATURE_OK;
    state->healthy = state->started;
    if (!state->started) {
        epg_pico_resource_taken = true;
    }
}

uint32_t __not_in_flash_func(epg_port_quadrature_count)(const epg_port_quadrature_t *decoder)
{
    decoder_t *state = &decoders[decoder->instance][decoder->slot];
    uint32_t word = 0;
    state->healthy = state->started && epg_pico_quadrature_newest(&state->encoder, &word);
    if (state->healthy) {
        state->count = state->encoder.reversed ? 0U - word : word;
    }
    return state->count;
}

bool __not_in_flash_func(epg_port_quadrature_healthy)(const epg_port_quadrature_t *decoder)
{
    return decoders[decoder->instance][decoder->slot].healthy;
}

void epg_pico_quadrature_stop_all(void)
{
    for (uint32_t block = 0; block < NUM_PIOS; block++) {
        for (uint32_t machine = 0; machine < STATE_MACHINES; machine++) {
            decoder_t *state = &decoders[block][machine];
            if (state->started) {
                epg_pico_quadrature_stop(&state->encoder);
                state->started = false;
            }
        }
    }
}
