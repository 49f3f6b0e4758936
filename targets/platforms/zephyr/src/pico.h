/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Fast access to the PWM and the pins of RP2040 and RP2350.
 *
 * These devices are registers of the chip.  They may be used in interrupts, and while interrupts are locked, because an
 * access never waits.
 *
 * Zephyr's PWM driver writes polarity, TOP, level and divider of a channel at each call.  Only the level changes after
 * the start, so a cycle writes only its register: 1.1 us for a level instead of 2.4 us (RP2040 at 125 MHz, simulated).
 * Less time is then needed between the output delay and the wrap at which the level takes effect.
 */
#ifndef EPG_ZEPHYR_PICO_H
#define EPG_ZEPHYR_PICO_H

#include <zephyr/devicetree.h>

#include <hardware/pwm.h>

#include "epg/zephyr.h"

#define EPG_PICO_PWM_NODE DT_NODELABEL(pwm)

static inline bool epg_zephyr_pico_has_pwm(const struct device *device)
{
    return device == DEVICE_DT_GET(EPG_PICO_PWM_NODE);
}

/**
 * One bit per slice: 1 if the devicetree has a divider for it.  Without one the driver divides each level by its own.
 */
#define EPG_PICO_PWM_DIVIDED(slice, _) ((DT_PROP_OR(EPG_PICO_PWM_NODE, divider_int_##slice, 0) != 0 ? 1U : 0U) << slice)

/**
 * Writes the high time of a channel, in clocks after the divider, to its register.  Must be called after
 * epg_port_pwm_start().  Returns false if the driver must be used instead: for another PWM device, for a slice without
 * a divider in the devicetree, or for a value of more than 16 bits.
 */
static inline bool epg_zephyr_pwm_take(const epg_zephyr_pwm_t *pwm, uint32_t pulse)
{
    const uint32_t divided = LISTIFY(8, EPG_PICO_PWM_DIVIDED, (|));
    const uint32_t slice = pwm->channel / 2U;
    if (!epg_zephyr_pico_has_pwm(pwm->device) || (divided >> slice & 1U) == 0U || pulse > UINT16_MAX) {
        return false;
    }
    pwm_set_chan_level(slice, pwm->channel % 2U, (uint16_t)pulse);
    return true;
}

#define EPG_PICO_IS_PORT(node) || port == DEVICE_DT_GET(node)

/** True if the port belongs to the chip, false if it belongs to an expander. */
static inline bool epg_zephyr_pico_has_port(const struct device *port)
{
    return false DT_FOREACH_STATUS_OKAY(raspberrypi_pico_gpio_port, EPG_PICO_IS_PORT);
}

#endif
