/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Quadrature decoders with 64-bit counts
 *
 * An incremental encoder has two outputs, A and B, the phases. While the shaft turns, each of them
 * is a square wave, and B is a quarter of a period behind or before A. A decoder counts every edge
 * of both phases (x4), so an encoder with 500 lines has 2000 counts per revolution. The order of
 * the edges gives the direction: the count rises while A leads B. The count is relative to the
 * position at which the device was started, until epg_qdec_set_count() presets it.
 *
 * A hardware counter has 16 or 32 bits and wraps. The drivers extend it to 64 bits: an interrupt or
 * a timer reads the counter often enough, so no wrap is lost even if the application does not read.
 *
 * These functions are for devices with one of the compatibles epg,pico-pio-qdec, epg,stm32-qdec and
 * epg,qdec-emul. The properties counts-per-revolution and invert are in the devicetree node.
 *
 * Zephyr's sensor API gives the angle. After sensor_sample_fetch(), sensor_channel_get() of
 * SENSOR_CHAN_ROTATION returns the angle in degrees from the position with the count 0. It includes
 * full turns: -450.18 degrees is val1 = -450, val2 = -180000. A controller should use the count
 * instead, which is exact and needs no fetch:
 *
 * @code{.c}
 *	const struct device *const dev = DEVICE_DT_GET(DT_NODELABEL(qdec));
 *	int64_t count;
 *
 *	if (epg_qdec_get_count(dev, &count) == 0) {
 *		...
 *	}
 * @endcode
 *
 * All functions can be called from interrupts and from threads in supervisor mode. Several contexts
 * can use the same device at the same time.
 */

#ifndef EPG_ZEPHYR_QDEC_H_
#define EPG_ZEPHYR_QDEC_H_

#include <errno.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/sys/util.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @brief Attributes of SENSOR_CHAN_ROTATION */
enum sensor_attribute_epg_qdec {
	/**
	 * Number of times that both phases changed at once. The direction of such a change is not
	 * known, so it is not counted. Reasons are edges that are too fast, noise, or a broken
	 * wire. The number is val1, at most INT32_MAX. Several such changes between two reads of
	 * the counter are one. Read-only; only for epg,pico-pio-qdec and epg,qdec-emul.
	 */
	SENSOR_ATTR_EPG_QDEC_SKIPPED = SENSOR_ATTR_PRIV_START,
};

#if defined(CONFIG_EPG_QDEC) || defined(__DOXYGEN__)

/**
 * @brief Read the count
 *
 * This is the present count, not that of the last fetch. Every edge of both phases counts (x4). The
 * count rises while A leads B; with the property invert it falls. The sensor API cannot return it,
 * because its values have only 32 bits and millionths.
 *
 * @param dev Decoder
 * @param[out] count Present count; unchanged after an error
 *
 * @retval 0 On success
 * @retval -EHOSTDOWN If the device is suspended
 * @retval -EIO If the hardware has stopped counting, because other code has changed its registers
 * @retval -ENOTSUP If the device is not such a decoder
 */
int epg_qdec_get_count(const struct device *dev, int64_t *count);

/**
 * @brief Preset the count
 *
 * The present count becomes @p count, and later edges are counted from there. No edge is lost. A
 * sample that was fetched before does not change.
 *
 * @param dev Decoder
 * @param count New count
 *
 * @return As epg_qdec_get_count()
 */
int epg_qdec_set_count(const struct device *dev, int64_t count);

#else /* an image without such a decoder */

static inline int epg_qdec_get_count(const struct device *dev, int64_t *count)
{
	ARG_UNUSED(dev);
	ARG_UNUSED(count);

	return -ENOTSUP;
}

static inline int epg_qdec_set_count(const struct device *dev, int64_t count)
{
	ARG_UNUSED(dev);
	ARG_UNUSED(count);

	return -ENOTSUP;
}

#endif

#ifdef __cplusplus
}
#endif

#endif /* EPG_ZEPHYR_QDEC_H_ */
