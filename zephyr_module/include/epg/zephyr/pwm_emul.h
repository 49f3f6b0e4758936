/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Outputs of an emulated PWM controller (epg,pwm-emul)
 *
 * The emulated controller has no pins. It stores the period and the pulse width that the firmware
 * sets with Zephyr's PWM API. A test or a simulated plant reads them with the functions below, and
 * can let a write fail. Times are in cycles of the emulated clock, whose frequency is the property
 * clock-frequency of the devicetree node.
 *
 * @code{.c}
 *	const struct device *const pwm = DEVICE_DT_GET(DT_NODELABEL(pwm));
 *	uint32_t period;
 *	uint32_t high;
 *
 *	if (epg_pwm_emul_get(pwm, 0, &period, &high) == 0 && period > 0) {
 *		duty = (double)high / period;
 *	}
 * @endcode
 */

#ifndef EPG_ZEPHYR_PWM_EMUL_H_
#define EPG_ZEPHYR_PWM_EMUL_H_

#include <stdint.h>

#include <zephyr/device.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Get the present output of a channel
 *
 * Can be called from threads and interrupts.
 *
 * @param dev Emulated controller
 * @param channel Number of the channel, from 0
 * @param[out] period Period in clock cycles; 0 before it was first set
 * @param[out] high Clock cycles of each period during which the output is high, also with an
 *             inverted polarity
 *
 * @retval 0 On success
 * @retval -EINVAL If there is no such channel
 */
int epg_pwm_emul_get(const struct device *dev, uint32_t channel, uint32_t *period, uint32_t *high);

/**
 * @brief Get the number of times that a channel was set
 *
 * @param dev Emulated controller
 * @param channel Number of the channel, from 0
 *
 * @return Number of successful writes, modulo 2^32; 0 if there is no such channel
 */
uint32_t epg_pwm_emul_writes(const struct device *dev, uint32_t channel);

/**
 * @brief Make writes to the emulated hardware fail
 *
 * A write that fails leaves the output as it is.
 *
 * @param dev Emulated controller
 * @param error Error that pwm_set_cycles() returns from now on: a negative error number, or 0 for
 *              no error
 */
void epg_pwm_emul_set_error(const struct device *dev, int error);

#ifdef __cplusplus
}
#endif

#endif /* EPG_ZEPHYR_PWM_EMUL_H_ */
