/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Emulated quadrature decoder (epg,qdec-emul)
 *
 * The emulated decoder has a counter of 16 or 32 bits without pins. A test or a simulated plant
 * turns its shaft with the functions below. The firmware reads it like any other decoder, with
 * epg/zephyr/qdec.h or the sensor API.
 *
 * @code{.c}
 *	epg_qdec_emul_move(qdec, 2000);
 *	epg_qdec_get_count(qdec, &count);
 * @endcode
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
 * The counter wraps and interrupts as a hardware counter would, also several times during one call.
 * Nothing is counted while the device is suspended.
 *
 * @param dev Emulated decoder
 * @param edges Number of edges of both phases: positive if A leads B, negative if B leads A
 */
void epg_qdec_emul_move(const struct device *dev, int64_t edges);

/**
 * @brief Let both phases change at once
 *
 * The direction of such a change is not known, so the count stays. The next read of the counter
 * adds 1 to SENSOR_ATTR_EPG_QDEC_SKIPPED.
 *
 * @param dev Emulated decoder
 */
void epg_qdec_emul_skip(const struct device *dev);

/**
 * @brief Make reads of the emulated hardware fail
 *
 * @param dev Emulated decoder
 * @param error Error that reads return from now on: a negative error number, or 0 for no error
 */
void epg_qdec_emul_set_error(const struct device *dev, int error);

/**
 * @brief Get the number of interrupts of the counter
 *
 * @param dev Emulated decoder
 *
 * @return Number of interrupts since the start, modulo 2^32
 */
uint32_t epg_qdec_emul_interrupts(const struct device *dev);

#ifdef __cplusplus
}
#endif

#endif /* EPG_ZEPHYR_QDEC_EMUL_H_ */
