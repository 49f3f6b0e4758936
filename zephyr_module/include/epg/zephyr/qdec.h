/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Quadrature decoders with 64-bit counts
 *
 * For devices with one of the compatibles epg,pico-pio-qdec, epg,stm32-qdec and epg,qdec-emul.
 *
 * The sensor API gives the angle: after sensor_sample_fetch(), sensor_channel_get() of
 * SENSOR_CHAN_ROTATION is the angle in degrees from where the count is 0, with micro-degrees and
 * with full turns: -450.18 degrees is val1 = -450, val2 = -180000. Controllers want the count
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
 * All functions can be called from interrupts and from threads in supervisor mode, also for one
 * device at a time.
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
	 * How often both phases had changed at once, which counts nothing: edges too fast, noise,
	 * or a broken wire. val1, up to INT32_MAX; several such changes between two reads are one.
	 * Only epg,pico-pio-qdec and epg,qdec-emul can tell; read-only.
	 */
	SENSOR_ATTR_EPG_QDEC_SKIPPED = SENSOR_ATTR_PRIV_START,
};

#if defined(CONFIG_EPG_QDEC) || defined(__DOXYGEN__)

/**
 * @brief Read the count
 *
 * The count of this moment, not of the last fetch. Every edge counts (x4), rising when A leads B
 * (falling with the property invert). The value of a sensor channel or attribute cannot hold it:
 * it has 32 bits and millionths.
 *
 * @param dev Decoder
 * @param count Where to put the count
 *
 * @retval 0 On success
 * @retval -EHOSTDOWN If the device is suspended
 * @retval -EIO If the hardware has stopped counting (something else has changed its registers)
 * @retval -ENOTSUP If the device is not such a decoder
 */
int epg_qdec_get_count(const struct device *dev, int64_t *count);

/**
 * @brief Preset the count
 *
 * The count at this moment becomes @p count; edges after it are counted from there. No edge is
 * lost, and a sample that has been fetched before stays as it is.
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
