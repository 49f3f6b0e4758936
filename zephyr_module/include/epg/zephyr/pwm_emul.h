/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief What an emulated PWM controller (epg,pwm-emul) puts out
 */

#ifndef EPG_ZEPHYR_PWM_EMUL_H_
#define EPG_ZEPHYR_PWM_EMUL_H_

#include <stdint.h>

#include <zephyr/device.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Get what a channel puts out
 *
 * Can be called from threads and interrupts.
 *
 * @param dev Emulated controller
 * @param channel Channel
 * @param period Where to put the period in clock cycles: 0 before it was first set
 * @param high Where to put how many of them the output is high, whatever the polarity
 *
 * @retval 0 On success
 * @retval -EINVAL If there is no such channel
 */
int epg_pwm_emul_get(const struct device *dev, uint32_t channel, uint32_t *period, uint32_t *high);

/**
 * @brief Get how often a channel has been set
 *
 * @param dev Emulated controller
 * @param channel Channel
 *
 * @return How often, modulo 2^32; 0 if there is no such channel
 */
uint32_t epg_pwm_emul_writes(const struct device *dev, uint32_t channel);

/**
 * @brief Let writes to the hardware fail
 *
 * @param dev Emulated controller
 * @param error What pwm_set_cycles() returns: 0, or a negative error number
 */
void epg_pwm_emul_set_error(const struct device *dev, int error);

#ifdef __cplusplus
}
#endif

#endif /* EPG_ZEPHYR_PWM_EMUL_H_ */
