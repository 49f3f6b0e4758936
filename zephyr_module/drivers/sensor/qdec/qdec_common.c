/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

#include <errno.h>

#include <epg/zephyr/qdec.h>

#include "qdec_common.h"

#define DEGREES_PER_REVOLUTION 360
#define MICRO                  1000000

/*
 * Adds the movement since the last update to the count. The caller must hold the lock.
 *
 * Returns -EHOSTDOWN if the device is suspended, or the error of the driver's read function.
 */
static int follow(const struct device *dev)
{
	const struct qdec_common_config *config = dev->config;
	struct qdec_common_data *data = dev->data;
	uint32_t counter;
	int32_t moved;
	int ret;

	if (!data->running) {
		return -EHOSTDOWN;
	}

	ret = config->read(dev, &counter);
	if (ret < 0) {
		return ret;
	}

	/*
	 * The counter wraps, so the difference is ambiguous. The shorter movement is the right one:
	 * the counter has moved by less than half of its range.
	 */
	moved = sign_extend(counter - data->counter, config->counter_bits - 1);
	data->counter = counter;
	data->count += config->invert ? -(int64_t)moved : (int64_t)moved;

	return 0;
}

int qdec_common_update(const struct device *dev)
{
	struct qdec_common_data *data = dev->data;
	int ret = 0;

	K_SPINLOCK(&data->lock) {
		ret = follow(dev);
	}

	return ret;
}

int qdec_common_start(const struct device *dev)
{
	const struct qdec_common_config *config = dev->config;
	struct qdec_common_data *data = dev->data;
	int ret = 0;

	K_SPINLOCK(&data->lock) {
		ret = config->read(dev, &data->counter);
		data->running = (ret == 0);
	}

	return ret;
}

void qdec_common_stop(const struct device *dev)
{
	struct qdec_common_data *data = dev->data;

	K_SPINLOCK(&data->lock) {
		(void)follow(dev);
		data->running = false;
	}
}

static int sample_fetch(const struct device *dev, enum sensor_channel chan)
{
	struct qdec_common_data *data = dev->data;
	int ret = 0;

	if (chan != SENSOR_CHAN_ALL && chan != SENSOR_CHAN_ROTATION) {
		return -ENOTSUP;
	}

	K_SPINLOCK(&data->lock) {
		ret = follow(dev);
		if (ret == 0) {
			data->fetched = data->count;
		}
	}

	return ret;
}

/*
 * Rounds towards zero, so the error is less than a micro-degree. Both parts of the value have the
 * sign of the count. Returns -ERANGE if the degrees do not fit into 32 bits.
 */
static int count_to_degrees(int64_t count, int64_t counts_per_revolution, struct sensor_value *val)
{
	const int64_t turns = count / counts_per_revolution;
	const int64_t part = (count % counts_per_revolution) * DEGREES_PER_REVOLUTION;
	int64_t degrees;

	if (turns > INT32_MAX / DEGREES_PER_REVOLUTION ||
	    turns < INT32_MIN / DEGREES_PER_REVOLUTION) {
		return -ERANGE;
	}

	degrees = turns * DEGREES_PER_REVOLUTION + part / counts_per_revolution;
	if (degrees > INT32_MAX || degrees < INT32_MIN) {
		return -ERANGE;
	}

	val->val1 = (int32_t)degrees;
	val->val2 = (int32_t)((part % counts_per_revolution) * MICRO / counts_per_revolution);

	return 0;
}

static int channel_get(const struct device *dev, enum sensor_channel chan,
		       struct sensor_value *val)
{
	const struct qdec_common_config *config = dev->config;
	struct qdec_common_data *data = dev->data;
	int64_t fetched = 0;

	if (chan != SENSOR_CHAN_ROTATION) {
		return -ENOTSUP;
	}

	K_SPINLOCK(&data->lock) {
		fetched = data->fetched;
	}

	return count_to_degrees(fetched, config->counts_per_revolution, val);
}

static int attr_get(const struct device *dev, enum sensor_channel chan, enum sensor_attribute attr,
		    struct sensor_value *val)
{
	const struct qdec_common_config *config = dev->config;
	struct qdec_common_data *data = dev->data;
	uint32_t skipped = 0;
	int ret = 0;

	if (chan != SENSOR_CHAN_ROTATION || (int)attr != SENSOR_ATTR_EPG_QDEC_SKIPPED ||
	    !config->notices_skips) {
		return -ENOTSUP;
	}

	K_SPINLOCK(&data->lock) {
		ret = follow(dev);
		skipped = data->skipped;
	}

	if (ret < 0) {
		return ret;
	}

	val->val1 = (int32_t)MIN(skipped, (uint32_t)INT32_MAX);
	val->val2 = 0;

	return 0;
}

DEVICE_API(sensor, qdec_common_driver_api) = {
	.attr_get = attr_get,
	.sample_fetch = sample_fetch,
	.channel_get = channel_get,
};

int epg_qdec_get_count(const struct device *dev, int64_t *count)
{
	struct qdec_common_data *data = dev->data;
	int ret = 0;

	if (dev->api != &qdec_common_driver_api) {
		return -ENOTSUP;
	}

	K_SPINLOCK(&data->lock) {
		ret = follow(dev);
		if (ret == 0) {
			*count = data->count;
		}
	}

	return ret;
}

int epg_qdec_set_count(const struct device *dev, int64_t count)
{
	struct qdec_common_data *data = dev->data;
	int ret = 0;

	if (dev->api != &qdec_common_driver_api) {
		return -ENOTSUP;
	}

	K_SPINLOCK(&data->lock) {
		ret = follow(dev);
		if (ret == 0) {
			data->count = count;
		}
	}

	return ret;
}
