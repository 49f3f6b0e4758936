/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * PWM and pins.  The functions that the control cycle calls are in RAM.
 */
#include "epg/port.h"

#include "parts.h"

uint32_t epg_pico_output_slices;
bool epg_pico_resource_taken;

/* PWM ---------------------------------------------------------------------------------------------------------- */

void epg_port_pwm_start(const epg_port_pwm_t *pwm)
{
    /* The slice is not enabled here: control_core.c enables all slices with one write to EN, in phase with the tick. */
    pwm_slice_hw_t *slice = &pwm_hw->slice[pwm->instance];
    slice->csr = 0;
    slice->div = (uint32_t)pwm->prescaler << PWM_CH0_DIV_INT_LSB;
    slice->top = pwm->top;
    slice->ctr = 0;
    epg_port_pwm_write(pwm, 0);
    gpio_set_function(pwm->pin, GPIO_FUNC_PWM);
    epg_pico_output_slices |= 1U << pwm->instance;
}

void __not_in_flash_func(epg_port_pwm_write)(const epg_port_pwm_t *pwm, uint32_t level)
{
    /*
     * Both channels of a slice share a register.  Only this core writes it, so reading, changing and writing is safe.
     */
    io_rw_32 *cc = &pwm_hw->slice[pwm->instance].cc;
    *cc = pwm->slot == PWM_CHAN_A ? (*cc & PWM_CH0_CC_B_BITS) | level
                                  : (*cc & PWM_CH0_CC_A_BITS) | level << PWM_CH0_CC_B_LSB;
}

/* Pins --------------------------------------------------------------------------------------------------------- */

void epg_port_output_start(uint8_t pin, bool level)
{
    gpio_put(pin, level);
    gpio_set_dir(pin, GPIO_OUT);
    gpio_set_function(pin, GPIO_FUNC_SIO);
}

void __not_in_flash_func(epg_port_output_write)(uint8_t pin, bool level)
{
    if (level) {
        sio_hw->gpio_set = 1U << pin;
    } else {
        sio_hw->gpio_clr = 1U << pin;
    }
}

void epg_port_input_start(uint8_t pin, epg_port_pull_t pull)
{
    gpio_init(pin);
    gpio_set_pulls(pin, pull == EPG_PULL_UP, pull == EPG_PULL_DOWN);
}

bool __not_in_flash_func(epg_port_input_read)(uint8_t pin)
{
    return (sio_hw->gpio_in >> pin & 1U) != 0U;
}
