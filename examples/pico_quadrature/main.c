/*
 * Prints the positions of two encoders, and resets one when the line "reset" comes.
 */
#include <stdio.h>
#include <string.h>

#include "epg/pico_quadrature.h"
#include "pico/stdlib.h"

#define PERIOD_US 100000u

static const epg_pico_quadrature_config_t pan_config = {
    .pin_a = 10,
    .pin_b = 11,
    .block = 0,
    .state_machine = EPG_PICO_QUADRATURE_ANY,
    .pull = EPG_PICO_QUADRATURE_PULL_UP, /* for encoders with open-collector outputs */
};
static const epg_pico_quadrature_config_t tilt_config = {
    .pin_a = 12,
    .pin_b = 13,
    .block = 0,
    .state_machine = EPG_PICO_QUADRATURE_ANY,
    .pull = EPG_PICO_QUADRATURE_PULL_UP,
    .invert = true,
};

static epg_pico_quadrature_t pan;
static epg_pico_quadrature_t tilt;

static void start(const char *name, epg_pico_quadrature_t *encoder, const epg_pico_quadrature_config_t *config)
{
    const epg_pico_quadrature_error_t error = epg_pico_quadrature_init(encoder, config);
    if (error != EPG_PICO_QUADRATURE_OK) {
        panic("encoder %s: %s", name, epg_pico_quadrature_error_text(error));
    }
}

/* True when a whole line "reset" has come. */
static bool reset_requested(void)
{
    static char line[16];
    static size_t length;
    const int character = getchar_timeout_us(0);
    if (character == PICO_ERROR_TIMEOUT) {
        return false;
    }
    if (character != '\n' && character != '\r') {
        line[length] = (char)character;
        length = length + 2 < sizeof line ? length + 1 : 0;
        return false;
    }
    line[length] = 0;
    length = 0;
    return strcmp(line, "reset") == 0;
}

int main(void)
{
    stdio_init_all();
    start("pan", &pan, &pan_config);
    start("tilt", &tilt, &tilt_config);
    absolute_time_t next = make_timeout_time_us(PERIOD_US);
    for (;;) {
        int64_t pan_position;
        int64_t tilt_position;
        const bool alive = epg_pico_quadrature_read(&pan, &pan_position) == EPG_PICO_QUADRATURE_OK &&
                           epg_pico_quadrature_read(&tilt, &tilt_position) == EPG_PICO_QUADRATURE_OK;
        if (!alive) {
            panic("an encoder does not answer");
        }
        if (reset_requested()) {
            epg_pico_quadrature_preset(&pan, 0);
            epg_pico_quadrature_preset(&tilt, 0);
        }
        if (time_reached(next)) {
            next = make_timeout_time_us(PERIOD_US);
            printf("pan %lld tilt %lld\n", (long long)pan_position, (long long)tilt_position);
        }
    }
}
