/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Quadrature encoders on the PIO: claims, settings and release of state machines.  See epg/pico_quadrature.h.
 */
#include "epg/pico_quadrature.h"

#include "hardware/gpio.h"

#define STATE_MACHINES 4u

/** The program that this file has loaded into a block, and the state machines that it has claimed there. */
typedef struct block_use {
    epg_pico_quadrature_variant_t variant;
    uint8_t claimed; /**< claimed state machines, one bit for each; 0: no program is loaded */
} block_use_t;

static block_use_t block_uses[NUM_PIOS];

static const struct pio_program count_program = {
    .instructions = epg_pico_quadrature_count_program,
    .length = EPG_PICO_QUADRATURE_COUNT_LENGTH,
    .origin = EPG_PICO_QUADRATURE_ORIGIN,
};

static const struct pio_program velocity_program = {
    .instructions = epg_pico_quadrature_velocity_program,
    .length = EPG_PICO_QUADRATURE_VELOCITY_LENGTH,
    .origin = EPG_PICO_QUADRATURE_ORIGIN,
};

static const struct pio_program *program_of(epg_pico_quadrature_variant_t variant)
{
    return variant == EPG_PICO_QUADRATURE_VELOCITY ? &velocity_program : &count_program;
}

static uint8_t lower_pin(const epg_pico_quadrature_config_t *config)
{
    return config->pin_a < config->pin_b ? config->pin_a : config->pin_b;
}

/**
 * Returns true if the block reaches both pins.  It reaches 32; on RP2350B, pio_set_gpio_base() can select 16 ... 47.
 */
static bool pins_in_reach(const epg_pico_quadrature_config_t *config, PIO pio)
{
    const uint32_t low = lower_pin(config);
    const uint32_t high = config->pin_a < config->pin_b ? config->pin_b : config->pin_a;
#if PICO_PIO_USE_GPIO_BASE
    const uint32_t first = pio_get_gpio_base(pio);
#else
    const uint32_t first = 0;
    (void)pio;
#endif
    return high - low == 1u && low >= first && high < first + 32u && high < NUM_BANK0_GPIOS;
}

/** Returns true if a pin has no function, or is an input that gpio_init() has made. */
static bool pin_is_free(uint32_t pin)
{
    const gpio_function_t function = gpio_get_function(pin);
    return function == GPIO_FUNC_NULL || (function == GPIO_FUNC_SIO && !gpio_is_dir_out(pin));
}

static epg_pico_quadrature_error_t check(const epg_pico_quadrature_config_t *config)
{
    if (config->block >= NUM_PIOS) {
        return EPG_PICO_QUADRATURE_ERROR_BLOCK;
    }
    if (!pins_in_reach(config, pio_get_instance(config->block))) {
        return EPG_PICO_QUADRATURE_ERROR_PINS;
    }
    if (!pin_is_free(config->pin_a) || !pin_is_free(config->pin_b)) {
        return EPG_PICO_QUADRATURE_ERROR_PIN_IN_USE;
    }
#if PICO_RP2350
    if (config->pull == EPG_PICO_QUADRATURE_PULL_DOWN) {
        return EPG_PICO_QUADRATURE_ERROR_PULL;
    }
#endif
    return EPG_PICO_QUADRATURE_OK;
}

static void set_up_pin(const epg_pico_quadrature_config_t *config, PIO pio, uint32_t pin)
{
    gpio_set_pulls(pin, config->pull == EPG_PICO_QUADRATURE_PULL_UP, config->pull == EPG_PICO_QUADRATURE_PULL_DOWN);
    pio_gpio_init(pio, pin); /* on RP2350 a pad is isolated until it has a function; an input of PIO needs one, too */
}

/** Sets the registers.  OSR must hold the present levels of the pins, so that the first sample finds no change. */
static void set_registers(PIO pio, uint32_t machine)
{
    pio_sm_exec(pio, machine, pio_encode_set(pio_y, 0));
    pio_sm_exec(pio, machine, pio_encode_mov_not(pio_x, pio_null));
    pio_sm_exec(pio, machine, pio_encode_mov(pio_isr, pio_null));
    pio_sm_exec(pio, machine, pio_encode_in(pio_pins, 2));
    pio_sm_exec(pio, machine, pio_encode_mov(pio_osr, pio_isr));
}

static void start(epg_pico_quadrature_t *encoder, const epg_pico_quadrature_config_t *config, uint32_t machine)
{
    const PIO pio = pio_get_instance(config->block);
    const bool velocity = config->variant == EPG_PICO_QUADRATURE_VELOCITY;
    *encoder = (epg_pico_quadrature_t){
        .pio = pio,
        .state_machine = (uint8_t)machine,
        .pin = lower_pin(config),
        .variant = config->variant,
        .reversed = config->invert != (config->pin_a > config->pin_b),
        .last = velocity ? 0xffffu : 0u,
    };
    set_up_pin(config, pio, config->pin_a);
    set_up_pin(config, pio, config->pin_b);

    pio_sm_config registers = pio_get_default_sm_config();
    sm_config_set_in_pins(&registers, encoder->pin);
    sm_config_set_in_shift(&registers, false, false, 32);
    sm_config_set_out_shift(&registers, true, false, 32);
    if (velocity) {
        sm_config_set_wrap(&registers, EPG_PICO_QUADRATURE_VELOCITY_WRAP_TARGET, EPG_PICO_QUADRATURE_VELOCITY_WRAP);
    } else {
        sm_config_set_wrap(&registers, EPG_PICO_QUADRATURE_COUNT_WRAP_TARGET, EPG_PICO_QUADRATURE_COUNT_WRAP);
    }
    pio_sm_init(pio, machine, velocity ? EPG_PICO_QUADRATURE_VELOCITY_START : EPG_PICO_QUADRATURE_COUNT_START,
                &registers);
    set_registers(pio, machine);
    (void)epg_pico_quadrature_take_skipped(encoder);
    pio_sm_set_enabled(pio, machine, true);
}

static epg_pico_quadrature_error_t find_machine(PIO pio, uint8_t wanted, uint32_t *machine)
{
    for (uint32_t n = 0; n < STATE_MACHINES; n++) {
        if ((wanted == n || wanted == EPG_PICO_QUADRATURE_ANY) && !pio_sm_is_claimed(pio, n)) {
            *machine = n;
            return EPG_PICO_QUADRATURE_OK;
        }
    }
    return EPG_PICO_QUADRATURE_ERROR_STATE_MACHINE;
}

epg_pico_quadrature_error_t epg_pico_quadrature_init(epg_pico_quadrature_t *encoder,
                                                     const epg_pico_quadrature_config_t *config)
{
    uint32_t machine = 0;
    epg_pico_quadrature_error_t error = check(config);
    if (error != EPG_PICO_QUADRATURE_OK) {
        return error;
    }
    const PIO pio = pio_get_instance(config->block);
    error = find_machine(pio, config->state_machine, &machine);
    if (error != EPG_PICO_QUADRATURE_OK) {
        return error;
    }
    block_use_t *use = &block_uses[config->block];
    if (use->claimed == 0) {
        if (!pio_can_add_program_at_offset(pio, program_of(config->variant), EPG_PICO_QUADRATURE_ORIGIN)) {
            return EPG_PICO_QUADRATURE_ERROR_INSTRUCTION_MEMORY;
        }
        pio_add_program_at_offset(pio, program_of(config->variant), EPG_PICO_QUADRATURE_ORIGIN);
        use->variant = config->variant;
    } else if (use->variant != config->variant) {
        return EPG_PICO_QUADRATURE_ERROR_INSTRUCTION_MEMORY;
    }
    pio_sm_claim(pio, machine);
    use->claimed = (uint8_t)(use->claimed | 1u << machine);
    start(encoder, config, machine);
    return EPG_PICO_QUADRATURE_OK;
}

epg_pico_quadrature_error_t epg_pico_quadrature_attach(epg_pico_quadrature_t *encoder,
                                                       const epg_pico_quadrature_config_t *config)
{
    const epg_pico_quadrature_error_t error = check(config);
    if (error != EPG_PICO_QUADRATURE_OK) {
        return error;
    }
    if (config->state_machine >= STATE_MACHINES) {
        return EPG_PICO_QUADRATURE_ERROR_STATE_MACHINE;
    }
    start(encoder, config, config->state_machine);
    return EPG_PICO_QUADRATURE_OK;
}

void epg_pico_quadrature_stop(epg_pico_quadrature_t *encoder)
{
    const uint32_t machine = encoder->state_machine;
    block_use_t *use = &block_uses[pio_get_index(encoder->pio)];
    const uint8_t bit = (uint8_t)(1u << machine);
    pio_sm_set_enabled(encoder->pio, machine, false);
    gpio_set_function(encoder->pin, GPIO_FUNC_NULL);
    gpio_set_function(encoder->pin + 1u, GPIO_FUNC_NULL);
    if ((use->claimed & bit) == 0) { /* an attached state machine belongs to the caller */
        return;
    }
    use->claimed = (uint8_t)(use->claimed & ~bit);
    pio_sm_unclaim(encoder->pio, machine);
    if (use->claimed == 0) {
        pio_remove_program(encoder->pio, program_of(use->variant), EPG_PICO_QUADRATURE_ORIGIN);
    }
}

const char *epg_pico_quadrature_error_text(epg_pico_quadrature_error_t error)
{
    switch (error) {
    case EPG_PICO_QUADRATURE_OK:
        return "no error";
    case EPG_PICO_QUADRATURE_ERROR_PINS:
        return "A and B must be neighbouring pins that the PIO block reaches";
    case EPG_PICO_QUADRATURE_ERROR_PIN_IN_USE:
        return "a pin is in use";
    case EPG_PICO_QUADRATURE_ERROR_PULL:
        return "no pull-down on RP2350 (erratum RP2350-E9)";
    case EPG_PICO_QUADRATURE_ERROR_BLOCK:
        return "there is no such PIO block";
    case EPG_PICO_QUADRATURE_ERROR_STATE_MACHINE:
        return "the state machine is not free";
    case EPG_PICO_QUADRATURE_ERROR_INSTRUCTION_MEMORY:
        return "the PIO block's instruction memory is in use";
    case EPG_PICO_QUADRATURE_ERROR_HALTED:
        return "the state machine does not run";
    }
    return "unknown error";
}
