/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Turning the shaft of an emulated quadrature decoder (epg,qdec-emul)
 */

#ifndef EPG_ZEPHYR_QDEC_EMUL_H_
#define EPG_ZEPHYR_QDEC_EMUL_H_

#include <stdint.h>

#include <zephyr/device.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Turn the shaft
 *
 * The counter wraps as often as it must, and interrupts as the hardware would. Nothing is counted
 * while the device is suspended.
 *
 * @param dev Emulated decoder
 * @param edges How far: positive when A leads B
 */
void epg_qdec_emul_move(const struct device *dev, int64_t edges);

/**
 * @brief Let both phases change at once, which counts nothing
 *
 * @param dev Emulated decoder
 */
void epg_qdec_emul_skip(const struct device *dev);

/**
 * @brief Let reads of the hardware fail
 *
 * @param dev Emulated decoder
 * @param error What a read returns: 0, or a negative error number
 */
void epg_qdec_emul_set_error(const struct device *dev, int error);

/**
 * @brief How often the counter has interrupted
 *
 * @param dev Emulated decoder
 */
uint32_t epg_qdec_emul_interrupts(const struct device *dev);

#ifdef __cplusplus
}
#endif

#endif /* EPG_ZEPHYR_QDEC_EMUL_H_ */
