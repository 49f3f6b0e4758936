/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The connection between the plant and the devices that Zephyr emulates: the plant sets inputs and reads outputs.
 *
 * The generator numbers the peripherals of each class from 0.  `slot` or `pin` is therefore enough to identify one.
 */
#include <stdio.h>

#include <epg/zephyr/pwm_emul.h>
#include <epg/zephyr/qdec_emul.h>
#include <zephyr/drivers/gpio/gpio_emul.h>
#include <zephyr/kernel.h>

#include "epg/plant.h"
#include "epg/zephyr.h"
#include "parts.h"

enum { UNITS = UINT8_MAX + 1, PINS = UINT8_MAX + 1 };

static bool turning;          /* a change of a shaft's position produces counts */
static int64_t counts[UNITS]; /* positions of the shafts, in counts */
/* The drivers of the input pins: `forced` replaces `driven`.  At the start both are 0. */
static epg_plant_force_t driven[PINS];
static epg_plant_force_t forced[PINS];

/* Devices -------------------------------------------------------------------------------------------------------- */

#define IS_DEVICE(node) || device == DEVICE_DT_GET(node)

static bool is_emulated_decoder(const struct device *device)
{
    ARG_UNUSED(device);
    return false DT_FOREACH_STATUS_OKAY(epg_qdec_emul, IS_DEVICE);
}

static bool is_emulated_pwm(const struct device *device)
{
    ARG_UNUSED(device);
    return false DT_FOREACH_STATUS_OKAY(epg_pwm_emul, IS_DEVICE);
}

static bool is_emulated_port(const struct device *device)
{
    ARG_UNUSED(device);
    return false DT_FOREACH_STATUS_OKAY(zephyr_gpio_emul, IS_DEVICE);
}

static bool complain(const struct device *device, const char *compatible)
{
    fprintf(stderr,
            "error: the plant cannot use '%s'\nhint: in the devicetree of native_sim it must be compatible with "
            "\"%s\", as in EPG's overlay\n",
            device->name, compatible);
    return false;
}

bool epg_native_sim_all_emulated(void)
{
    const epg_zephyr_hardware_t *hardware = &epg_zephyr_hardware;
    bool good = true;
    for (size_t i = 0; i < hardware->decoder_count; i++) {
        const struct device *device = hardware->decoders[i].device;
        good = (is_emulated_decoder(device) || complain(device, "epg,qdec-emul")) && good;
    }
    for (size_t i = 0; i < hardware->pwm_count; i++) {
        const struct device *device = hardware->pwms[i].device;
        good = (is_emulated_pwm(device) || complain(device, "epg,pwm-emul")) && good;
    }
    for (size_t i = 0; i < hardware->pin_count; i++) {
        const struct device *device = hardware->pins[i].gpio.port;
        good = (is_emulated_port(device) || complain(device, "zephyr,gpio-emul")) && good;
    }
    return good;
}

static const struct device *decoder_of(uint8_t slot)
{
    const epg_zephyr_hardware_t *hardware = &epg_zephyr_hardware;
    for (size_t i = 0; i < hardware->decoder_count; i++) {
        if (hardware->decoders[i].slot == slot) {
            return hardware->decoders[i].device;
        }
    }
    return NULL;
}

static const struct gpio_dt_spec *gpio_of(uint8_t pin)
{
    const epg_zephyr_hardware_t *hardware = &epg_zephyr_hardware;
    for (size_t i = 0; i < hardware->pin_count; i++) {
        if (hardware->pins[i].pin == pin) {
            return &hardware->pins[i].gpio;
        }
    }
    return NULL;
}

/* Quadrature decoders ---------------------------------------------------------------------------------------------- */

void epg_native_sim_shafts_turn(void)
{
    turning = true;
}

/**
 * Turns a shaft to the position `count`.  Before the decoders run this sets its initial position, and no count changes:
 * an incremental encoder does not know the position.
 */
void epg_plant_quadrature_set(uint8_t slot, int64_t count)
{
    const struct device *device = decoder_of(slot);
    /* Modulo 2^32, like the counts of the target.  This also limits the time for an absurd position. */
    const int32_t edges = (int32_t)(uint32_t)((uint64_t)count - (uint64_t)counts[slot]);
    counts[slot] = count;
    if (turning && device != NULL && edges != 0) {
        epg_qdec_emul_move(device, edges);
    }
}

void epg_plant_quadrature_fail(uint8_t slot, bool failed)
{
    const struct device *device = decoder_of(slot);
    if (device != NULL) {
        epg_qdec_emul_set_error(device, failed ? -EIO : 0);
    }
}

/*
 * PWM ----------------------------------------------------------------------------------------------------------------
 */

double epg_plant_pwm_duty(uint8_t slot)
{
    const epg_zephyr_hardware_t *hardware = &epg_zephyr_hardware;
    for (size_t i = 0; i < hardware->pwm_count; i++) {
        const epg_zephyr_pwm_t *pwm = &hardware->pwms[i];
        uint32_t period = 0;
        uint32_t high = 0;
        if (pwm->slot == slot && epg_pwm_emul_get(pwm->device, pwm->channel, &period, &high) == 0 && period > 0) {
            return (double)high / (double)period;
        }
    }
    return 0.0;
}

/*
 * Pins ---------------------------------------------------------------------------------------------------------------
 */

static bool is_configured(const struct gpio_dt_spec *gpio, gpio_flags_t direction)
{
    gpio_flags_t flags = 0;
    return gpio != NULL && gpio_emul_flags_get(gpio->port, gpio->pin, &flags) == 0 && (flags & direction) != 0;
}

bool epg_plant_output(uint8_t pin)
{
    const struct gpio_dt_spec *gpio = gpio_of(pin);
    return is_configured(gpio, GPIO_OUTPUT) && gpio_emul_output_get(gpio->port, gpio->pin) > 0;
}

/** Sets the level of an emulated input pin: that of its driver, or that of its pull resistor if nothing drives it. */
static void drive(uint8_t pin)
{
    const struct gpio_dt_spec *gpio = gpio_of(pin);
    const epg_plant_force_t driver = forced[pin] == EPG_PLANT_FORCE_NONE ? driven[pin] : forced[pin];
    gpio_flags_t flags = 0;
    if (is_configured(gpio, GPIO_INPUT) && gpio_emul_flags_get(gpio->port, gpio->pin, &flags) == 0) {
        const bool pulled_up = driver != EPG_PLANT_FORCE_LOW && (flags & GPIO_PULL_UP) != 0;
        const bool high = driver == EPG_PLANT_FORCE_HIGH || pulled_up;
        (void)gpio_emul_input_set(gpio->port, gpio->pin, high ? 1 : 0);
    }
}

void epg_plant_input_set(uint8_t pin, bool level)
{
    driven[pin] = level ? EPG_PLANT_FORCE_HIGH : EPG_PLANT_FORCE_LOW;
    drive(pin);
}

void epg_plant_input_force(uint8_t pin, epg_plant_force_t force)
{
    forced[pin] = force;
    drive(pin);
}

void epg_native_sim_drive_pins(void)
{
    for (unsigned int pin = 0; pin < PINS; pin++) {
        if (driven[pin] != EPG_PLANT_FORCE_NONE || forced[pin] != EPG_PLANT_FORCE_NONE) {
            drive((uint8_t)pin);
        }
    }
}
