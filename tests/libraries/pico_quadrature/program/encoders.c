/*
 * Up to twelve encoders through the public API.  The test writes `parameters` and `request`, and waits until `done` has
 * the same value; `request` is then 0 again.
 */
#include "epg/pico_quadrature.h"
#include "epg/pico_quadrature_velocity.h"
#include "pico/stdlib.h"

#define ENCODERS 12u

enum { REQUEST_NONE, REQUEST_INIT, REQUEST_READ, REQUEST_WATCH, REQUEST_STOP, REQUEST_PRESET, REQUEST_OTHERS };

/* pin A, pin B, block, state machine, variant, pull, invert, attach */
volatile uint32_t parameters[ENCODERS][8];
volatile uint32_t count;
volatile uint32_t request;
volatile uint32_t done;
volatile uint32_t errors[ENCODERS];
volatile uint32_t rounds;
volatile uint32_t failures;
volatile uint32_t skipped[ENCODERS];
volatile int64_t positions[ENCODERS];
volatile int64_t preset_to;
volatile double velocities[ENCODERS];
volatile uint32_t others; /* resources that REQUEST_OTHERS occupies */

epg_pico_quadrature_t encoders[ENCODERS];
static epg_pico_quadrature_velocity_t estimates[ENCODERS];

static void init_all(void)
{
    for (uint32_t n = 0; n < count; n++) {
        const epg_pico_quadrature_config_t config = {
            .pin_a = (uint8_t)parameters[n][0],
            .pin_b = (uint8_t)parameters[n][1],
            .block = (uint8_t)parameters[n][2],
            .state_machine = (uint8_t)parameters[n][3],
            .variant = (epg_pico_quadrature_variant_t)parameters[n][4],
            .pull = (epg_pico_quadrature_pull_t)parameters[n][5],
            .invert = parameters[n][6] != 0,
        };
        errors[n] = parameters[n][7] != 0 ? epg_pico_quadrature_attach(&encoders[n], &config)
                                          : epg_pico_quadrature_init(&encoders[n], &config);
        epg_pico_quadrature_velocity_init(&estimates[n], time_us_64() * 1000u, 100000000u);
    }
}

/* The test measures the time of this: one read of a position. */
epg_pico_quadrature_error_t __attribute__((noinline))
__not_in_flash_func(read_once)(epg_pico_quadrature_t *encoder, int64_t *position)
{
    return epg_pico_quadrature_read(encoder, position);
}

static void __not_in_flash_func(read_all)(void)
{
    for (uint32_t n = 0; n < count; n++) {
        int64_t position = 0;
        epg_pico_quadrature_error_t error;
        if (encoders[n].variant == EPG_PICO_QUADRATURE_VELOCITY) {
            error = epg_pico_quadrature_velocity_read(&estimates[n], &encoders[n], time_us_64() * 1000u, &position);
            velocities[n] = estimates[n].velocity;
        } else {
            error = read_once(&encoders[n], &position);
        }
        errors[n] = error;
        positions[n] = position;
        skipped[n] = encoders[n].skipped;
        failures += error != EPG_PICO_QUADRATURE_OK;
    }
    rounds++;
}

/* Resources that others have taken: 1 state machine, 2 instruction memory, 4 pin for PWM, 8 pin as output. */
static void occupy(void)
{
    static const uint16_t nop[] = {0xa042};
    static const struct pio_program program = {.instructions = nop, .length = 1, .origin = 3};
    if (others & 1u) {
        pio_sm_claim(pio0, 2);
    }
    if (others & 2u) {
        pio_add_program_at_offset(pio0, &program, 3);
    }
    if (others & 4u) {
        gpio_set_function(10, GPIO_FUNC_PWM);
    }
    if (others & 8u) {
        gpio_init(11);
        gpio_set_dir(11, true);
    }
    if (others & 16u) {
        static const struct pio_program quadrature = {
            .instructions = epg_pico_quadrature_count_program,
            .length = EPG_PICO_QUADRATURE_COUNT_LENGTH,
            .origin = EPG_PICO_QUADRATURE_ORIGIN,
        };
        pio_add_program(pio1, &quadrature);
        pio_sm_claim(pio1, 1);
    }
}

int main(void)
{
    for (;;) {
        const uint32_t wanted = request;
        if (wanted == REQUEST_NONE) {
            continue;
        }
        switch (wanted) {
        case REQUEST_INIT:
            init_all();
            break;
        case REQUEST_READ:
            read_all();
            break;
        case REQUEST_WATCH:
            while (request == REQUEST_WATCH) {
                read_all();
                busy_wait_us(20);
            }
            continue;
        case REQUEST_STOP:
            for (uint32_t n = 0; n < count; n++) {
                epg_pico_quadrature_stop(&encoders[n]);
            }
            break;
        case REQUEST_PRESET:
            for (uint32_t n = 0; n < count; n++) {
                epg_pico_quadrature_preset(&encoders[n], preset_to);
            }
            break;
        case REQUEST_OTHERS:
            occupy();
            break;
        default:
            break;
        }
        done = wanted;
        request = REQUEST_NONE;
    }
}
