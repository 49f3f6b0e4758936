/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Pins, PWM outputs and encoders, as variables.
 */
#include "epg/one_core.h"
#include "epg/port.h"

volatile mps2_pin_t mps2_pins[MPS2_PINS];
volatile uint32_t mps2_levels[MPS2_PWM_OUTPUTS];
static uint16_t tops[MPS2_PWM_OUTPUTS];

double mps2_duty(uint8_t pin)
{
    const volatile mps2_pin_t *state = &mps2_pins[pin];
    return state->by_pwm ? (double)mps2_levels[state->output] / ((double)tops[state->output] + 1.0)
           : state->high ? 1.0
                         : 0.0;
}

void epg_one_core_outputs_safe(void)
{
    for (size_t i = 0; i < epg_mps2_outputs.count; i++) {
        const epg_mps2_output_t *output = &epg_mps2_outputs.pins[i];
        mps2_pins[output->pin].high = output->high;
        mps2_pins[output->pin].by_pwm = false;
    }
}

void epg_port_pwm_start(const epg_port_pwm_t *pwm)
{
    tops[pwm->slot] = pwm->top;
    mps2_levels[pwm->slot] = 0U;
    mps2_pins[pwm->pin].output = pwm->slot;
    mps2_pins[pwm->pin].by_pwm = true;
}

void epg_port_pwm_write(const epg_port_pwm_t *pwm, uint32_t level)
{
    mps2_levels[pwm->slot] = level;
}

void epg_port_output_start(uint8_t pin, bool level)
{
    mps2_pins[pin].high = level;
    mps2_pins[pin].by_pwm = false;
}

void epg_port_output_write(uint8_t pin, bool level)
{
    mps2_pins[pin].high = level;
}

void epg_port_input_start(uint8_t pin, epg_port_pull_t pull)
{
    mps2_pins[pin].high = pull == EPG_PULL_UP;
}

bool epg_port_input_read(uint8_t pin)
{
    return mps2_pins[pin].high;
}

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    (void)decoder;
}

uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    return mps2_count(decoder->pin_a);
}

bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    (void)decoder;
    return true;
}
