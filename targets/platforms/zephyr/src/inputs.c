/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Inputs: quadrature decoders and pins.  A decoder is a device of the sensor API that reports its count
 * (epg/zephyr/qdec.h).
 *
 * On RP2040 and RP2350 the tick's interrupt reads the inputs.  No other interrupt and no thread can delay it, so inputs
 * are read at the same distance from the tick in each cycle, however late the control thread begins.
 *
 * Some pins have a driver that may wait, for example those of an expander on I2C.  They cannot be read in an interrupt;
 * the control thread reads them at the begin of its cycle.
 */
#include <epg/zephyr/qdec.h>
#include <zephyr/kernel.h>

#include "epg/port.h"
#include "parts.h"
#ifdef CONFIG_EPG_TICK_PICO_PWM
#include "pico.h"
#endif

/** Largest number of decoders.  A target with more does not start. */
#define DECODERS 16U
/** Largest number of rows in the table of pins.  A target whose inputs are in later rows does not start. */
#define PINS 64U

/* The result of the last reading, by row of the table of decoders. */
static struct {
    uint32_t count;
    bool healthy;
} newest[DECODERS];

/* By row of the table of pins: true if the tick's interrupt reads the pin, and the level that it has read. */
static struct {
    bool in_interrupt;
    bool level;
} levels[PINS];

/** Used by the control thread: `newest` and `levels` belong to the tick of the present cycle. */
static bool sampled;

static size_t decoder_rows(void)
{
    return MIN(epg_zephyr_hardware.decoder_count, DECODERS);
}

static size_t pin_rows(void)
{
    return MIN(epg_zephyr_hardware.pin_count, PINS);
}

static void read_decoder(size_t row)
{
    int64_t count = 0;
    newest[row].healthy = epg_qdec_get_count(epg_zephyr_hardware.decoders[row].device, &count) == 0;
    if (newest[row].healthy) {
        newest[row].count = (uint32_t)count;
    }
}

static bool read_pin(size_t row)
{
    return gpio_pin_get_dt(&epg_zephyr_hardware.pins[row].gpio) > 0;
}

void epg_zephyr_inputs_sample(void)
{
    for (size_t row = 0; row < decoder_rows(); row++) {
        read_decoder(row);
    }
    for (size_t row = 0; row < pin_rows(); row++) {
        if (levels[row].in_interrupt) {
            levels[row].level = read_pin(row);
        }
    }
}

void epg_zephyr_inputs_use(bool of_tick)
{
    sampled = of_tick;
}

/* Decoders ------------------------------------------------------------------------------------------------------- */

static bool find_decoder(const epg_port_quadrature_t *decoder, size_t *row)
{
    for (*row = 0; *row < decoder_rows(); (*row)++) {
        const epg_zephyr_decoder_t *candidate = &epg_zephyr_hardware.decoders[*row];
        if (candidate->instance == decoder->instance && candidate->slot == decoder->slot) {
            return true;
        }
    }
    return false;
}

uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    size_t row;
    if (!find_decoder(decoder, &row)) {
        return 0;
    }
    if (!sampled) {
        read_decoder(row);
    }
    return newest[row].count;
}

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    (void)epg_port_quadrature_count(decoder);
    if (!epg_port_quadrature_healthy(decoder)) {
        epg_zephyr_device_refused = true;
    }
}

bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    size_t row;
    return find_decoder(decoder, &row) && newest[row].healthy;
}

/* Pins ------------------------------------------------------------------------------------------------------------ */

static bool find_pin(uint8_t pin, size_t *row)
{
    const epg_zephyr_pin_t *found = epg_zephyr_pin(pin);
    if (found == NULL || found >= &epg_zephyr_hardware.pins[pin_rows()]) {
        return false;
    }
    *row = (size_t)(found - epg_zephyr_hardware.pins);
    return true;
}

/** True if the port's driver only reads a register. */
static bool can_be_read_in_interrupt(const struct device *port)
{
#ifdef CONFIG_EPG_TICK_PICO_PWM
    return epg_zephyr_pico_has_port(port);
#else
    ARG_UNUSED(port);
    return false;
#endif
}

void epg_port_input_start(uint8_t pin, epg_port_pull_t pull)
{
    static const gpio_flags_t pulls[] = {
        [EPG_PULL_NONE] = 0,
        [EPG_PULL_UP] = GPIO_PULL_UP,
        [EPG_PULL_DOWN] = GPIO_PULL_DOWN,
    };
    size_t row;
    if (!find_pin(pin, &row)) {
        epg_zephyr_device_refused = true;
        return;
    }
    const struct gpio_dt_spec *gpio = &epg_zephyr_hardware.pins[row].gpio;
    if (gpio_pin_configure_dt(gpio, GPIO_INPUT | pulls[pull]) < 0) {
        epg_zephyr_device_refused = true;
    }
    levels[row].in_interrupt = can_be_read_in_interrupt(gpio->port);
}

bool epg_port_input_read(uint8_t pin)
{
    size_t row;
    if (!find_pin(pin, &row)) {
        return false;
    }
    return sampled && levels[row].in_interrupt ? levels[row].level : read_pin(row);
}
