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
 *	if (qdec_get_count(dev, &count) == 0) {
 *		...
 *	}
 * @endcode
 *
 * All functions can be called from threads and interrupts, also for one device at a time.
 */

#ifndef EPG_ZEPHYR_QDEC_H_
#define EPG_ZEPHYR_QDEC_H_

#include <errno.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/drivers/sensor.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @brief Attributes of SENSOR_CHAN_ROTATION */
enum sensor_attribute_epg_qdec {
	/**
	 * The count now, read from the hardware, as 64-bit two's complement: val1 is the upper
	 * half, val2 the lower. Setting it is a preset: the count at this moment becomes the given
	 * one, no edge is lost, and a sample that has been fetched before stays as it is.
	 */
	SENSOR_ATTR_QDEC_COUNT = SENSOR_ATTR_PRIV_START,
	/**
	 * How often both phases had changed at once, which counts nothing: edges too fast, noise,
	 * or a broken wire. val1, up to INT32_MAX; several such changes between two reads are one.
	 * Only epg,pico-pio-qdec and epg,qdec-emul can tell; read-only.
	 */
	SENSOR_ATTR_QDEC_SKIPPED,
};

/**
 * @brief Read the count
 *
 * The count of this moment, not of the last fetch. Every edge counts (x4), rising when A leads B
 * (falling with the property invert).
 *
 * @param dev Decoder
 * @param count Where to put the count
 *
 * @retval 0 On success
 * @retval -EHOSTDOWN If the device is suspended
 * @retval -EIO If the hardware has stopped counting (something else has changed its registers)
 * @retval -ENOTSUP, -ENOSYS If the device is no such decoder
 */
static inline int qdec_get_count(const struct device *dev, int64_t *count)
{
	struct sensor_value value;
	int ret;

	ret = sensor_attr_get(dev, SENSOR_CHAN_ROTATION,
			      (enum sensor_attribute)SENSOR_ATTR_QDEC_COUNT, &value);
	if (ret < 0) {
		return ret;
	}

	*count = (int64_t)(((uint64_t)(uint32_t)value.val1 << 32) | (uint32_t)value.val2);

	return 0;
}

/**
 * @brief Preset the count
 *
 * The count at this moment becomes @p count; edges after it are counted from there.
 *
 * @param dev Decoder
 * @param count What the count shall be
 *
 * @return As qdec_get_count()
 */
static inline int qdec_set_count(const struct device *dev, int64_t count)
{
	struct sensor_value value = {
		.val1 = (int32_t)(uint32_t)((uint64_t)count >> 32),
		.val2 = (int32_t)(uint32_t)count,
	};

	return sensor_attr_set(dev, SENSOR_CHAN_ROTATION,
			       (enum sensor_attribute)SENSOR_ATTR_QDEC_COUNT, &value);
}

#ifdef __cplusplus
}
#endif

#endif /* EPG_ZEPHYR_QDEC_H_ */
