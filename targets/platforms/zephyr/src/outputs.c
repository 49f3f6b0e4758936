/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Outputs: PWM and pins.
 *
 * A driver may refuse a write, for example because an expander does not answer, a clock is off, or other code uses the
 * channel.  The component is then brought into a safe state and not used until the next reset (epg/outputs.h).  The
 * target is disabled with the fault EPG_FAULT_OUTPUT.
 */
#include <zephyr/drivers/pwm.h>
#include <zephyr/kernel.h>

#include "epg/port.h"
#include "parts.h"
#ifdef CONFIG_EPG_TICK_PICO_PWM
#include "pico.h"
#endif

#define NS_PER_S 1000000000U

/** Largest number of rows in the table of pins.  A target whose outputs are in later rows does not start. */
#define PINS 64U

/** In place of a row: the pin is not in the table of outputs. */
#define NO_ROW UINT8_MAX
BUILD_ASSERT(NO_ROW >= EPG_OUTPUTS_ROWS, "no row of the table");

static epg_outputs_t outputs;

static uint8_t output_row(uint8_t pin)
{
    for (size_t i = 0; i < epg_zephyr_hardware.output_count && i < EPG_OUTPUTS_ROWS; i++) {
        if (epg_zephyr_hardware.outputs[i].pin == pin) {
            return (uint8_t)i;
        }
    }
    return NO_ROW;
}

/* PWM ------------------------------------------------------------------------------------------------------------ */

/** Largest number of PWM outputs.  A target with more does not start. */
#define PWMS 32U

/*
 * The PWM period in clocks of the device, by row of the table of PWMs.  Computed once: it takes a division of 64 bits.
 */
static uint32_t periods[PWMS];

/* The row in the table of outputs, by row of the table of PWMs. */
static uint8_t pwm_outputs[PWMS];

static const epg_zephyr_pwm_t *find_pwm(uint8_t instance, uint8_t slot, size_t *row)
{
    for (size_t i = 0; i < epg_zephyr_hardware.pwm_count && i < PWMS; i++) {
        const epg_zephyr_pwm_t *pwm = &epg_zephyr_hardware.pwms[i];
        if (pwm->instance == instance && pwm->slot == slot) {
            *row = i;
            return pwm;
        }
    }
    return NULL;
}

static int find_period(const epg_port_pwm_t *config)
{
    size_t row = 0;
    uint64_t rate = 0;
    const epg_zephyr_pwm_t *pwm = find_pwm(config->instance, config->slot, &row);
    if (pwm == NULL) {
        return -ENODEV;
    }
    periods[row] = config->top + 1U;
    if (pwm->period_ns == 0) {
        return 0;
    }
    const int error = pwm_get_cycles_per_sec(pwm->device, pwm->channel, &rate);
    periods[row] = (uint32_t)(pwm->period_ns * rate / NS_PER_S);
    return error;
}

/** The high time in clocks of the device, for `level` out of `steps`. */
static inline uint32_t pulse_of(uint32_t level, uint32_t steps, uint32_t period)
{
    return period == steps ? level : (uint32_t)((uint64_t)period * level / steps);
}

/**
 * Sets an output to a constant level.  Its pin becomes a plain output.  If the application's devicetree defines the
 * PWM, its pin is not known; then the PWM's driver sets the level.
 */
static bool take_over(size_t row, bool high)
{
    const epg_zephyr_pin_t *pin = epg_zephyr_pin(epg_zephyr_hardware.outputs[row].pin);
    if (pin != NULL && gpio_pin_configure_dt(&pin->gpio, high ? GPIO_OUTPUT_ACTIVE : GPIO_OUTPUT_INACTIVE) >= 0) {
        return true;
    }
    for (size_t i = 0; pin == NULL && i < epg_zephyr_hardware.pwm_count && i < PWMS; i++) {
        const epg_zephyr_pwm_t *pwm = &epg_zephyr_hardware.pwms[i];
        if (pwm_outputs[i] == row) {
            return pwm_set_cycles(pwm->device, pwm->channel, periods[i], high ? periods[i] : 0U, pwm->flags) >= 0;
        }
    }
    return false;
}

static void refuse(uint8_t row)
{
    epg_zephyr_device_refused = true; /* makes a start fail that is in progress */
    epg_outputs_refused(&outputs, row, take_over);
}

static int set_pulse(size_t i, uint32_t pulse)
{
    const epg_zephyr_pwm_t *pwm = &epg_zephyr_hardware.pwms[i];
#ifdef CONFIG_EPG_TICK_PICO_PWM
    if (epg_zephyr_pwm_take(pwm, pulse)) {
        return 0;
    }
#endif
    return pwm_set_cycles(pwm->device, pwm->channel, periods[i], pulse, pwm->flags);
}

void epg_port_pwm_start(const epg_port_pwm_t *config)
{
    size_t i = 0;
    const epg_zephyr_pwm_t *pwm = find_pwm(config->instance, config->slot, &i);
    if (pwm == NULL) {
        epg_zephyr_device_refused = true;
        return;
    }
    pwm_outputs[i] = output_row(config->pin);
    if (find_period(config) < 0 || pwm_set_cycles(pwm->device, pwm->channel, periods[i], 0, pwm->flags) < 0) {
        refuse(pwm_outputs[i]);
    }
}

void epg_port_pwm_write(const epg_port_pwm_t *config, uint32_t level)
{
    size_t i = 0;
    if (find_pwm(config->instance, config->slot, &i) == NULL || !epg_outputs_may_write(&outputs, pwm_outputs[i])) {
        return;
    }
    const uint32_t pulse = pulse_of(level, config->top + 1U, periods[i]);
    if (set_pulse(i, pulse) < 0) {
        refuse(pwm_outputs[i]);
        return;
    }
    epg_outputs_written(&outputs, pwm_outputs[i],
                        pulse == 0U          ? EPG_LEVEL_LOW
                        : pulse < periods[i] ? EPG_LEVEL_SWITCHING
                                             : EPG_LEVEL_HIGH);
}

/* Pins ------------------------------------------------------------------------------------------------------------ */

/* The row in the table of outputs, by row of the table of pins. */
static uint8_t pin_outputs[PINS];

static bool find_pin(uint8_t pin, size_t *row)
{
    const epg_zephyr_pin_t *found = epg_zephyr_pin(pin);
    if (found == NULL) {
        return false;
    }
    *row = (size_t)(found - epg_zephyr_hardware.pins);
    return *row < PINS;
}

void epg_port_output_start(uint8_t pin, bool level)
{
    size_t row;
    if (!find_pin(pin, &row)) {
        epg_zephyr_device_refused = true;
        return;
    }
    pin_outputs[row] = output_row(pin);
    if (gpio_pin_configure_dt(&epg_zephyr_hardware.pins[row].gpio, level ? GPIO_OUTPUT_ACTIVE : GPIO_OUTPUT_INACTIVE) <
        0) {
        refuse(pin_outputs[row]);
        return;
    }
    epg_outputs_written(&outputs, pin_outputs[row], level ? EPG_LEVEL_HIGH : EPG_LEVEL_LOW);
}

void epg_port_output_write(uint8_t pin, bool level)
{
    size_t row;
    if (!find_pin(pin, &row) || !epg_outputs_may_write(&outputs, pin_outputs[row])) {
        return;
    }
    if (gpio_pin_set_dt(&epg_zephyr_hardware.pins[row].gpio, level ? 1 : 0) < 0) {
        refuse(pin_outputs[row]);
        return;
    }
    epg_outputs_written(&outputs, pin_outputs[row], level ? EPG_LEVEL_HIGH : EPG_LEVEL_LOW);
}

/*
 * All ---------------------------------------------------------------------------------------------------------------
 */

bool epg_zephyr_outputs_start(void)
{
    if (outputs.refused) {
        return false;
    }
    epg_outputs_start(&outputs, epg_zephyr_hardware.groups, epg_zephyr_hardware.group_count);
    return true;
}

void epg_zephyr_outputs_check(epg_control_t *control)
{
    if (outputs.refused) {
        epg_control_fault(control, EPG_FAULT_OUTPUT, outputs.component);
    }
}

bool epg_zephyr_outputs_unsafe(void)
{
    return outputs.unsafe;
}

bool epg_zephyr_outputs_are_registers(void)
{
#ifdef CONFIG_EPG_TICK_PICO_PWM
    const epg_zephyr_hardware_t *hardware = &epg_zephyr_hardware;
    for (size_t i = 0; i < hardware->pwm_count; i++) {
        if (!epg_zephyr_pico_has_pwm(hardware->pwms[i].device)) {
            return false;
        }
    }
    for (size_t i = 0; i < hardware->output_count; i++) {
        const epg_zephyr_pin_t *row = epg_zephyr_pin(hardware->outputs[i].pin);
        if (row != NULL && !epg_zephyr_pico_has_port(row->gpio.port)) {
            return false;
        }
    }
    return true;
#else
    return false;
#endif
}
