/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Devices of RP2040 and RP2350 that are registers: they may be used in interrupts, and while interrupts are locked.
 *
 * PWM by one register: Zephyr's driver sets polarity, TOP, level and divider of a channel at each call.  All but the level stay as they were
 * at the start, so in a cycle that one register is enough, and the time between an output's instant and the wrap at which
 * it is to act is short: 1.1 us for a level instead of 2.4 us (RP2040 at 125 MHz, simulated).
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

/** Where the devicetree has no divider, the driver computes one, and divides the level by it. */
#define EPG_PICO_PWM_DIVIDED(slice, _) ((DT_PROP_OR(EPG_PICO_PWM_NODE, divider_int_##slice, 0) != 0 ? 1U : 0U) << slice)

/** Takes over a high time in clocks that have been divided, after epg_port_pwm_start(); false: the driver has to. */
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

/** Whether pins are the chip's own, and not an expander's. */
static inline bool epg_zephyr_pico_has_port(const struct device *port)
{
    return false DT_FOREACH_STATUS_OKAY(raspberrypi_pico_gpio_port, EPG_PICO_IS_PORT);
}

#endif
