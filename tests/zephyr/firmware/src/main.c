/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief Decoders of an emulated chip, controlled by requests of a test
 *
 * The decoders are those of the property qdecs of the node zephyr,user.
 */

#include <errno.h>
#include <stdint.h>

#include <zephyr/device.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/kernel.h>
#include <zephyr/pm/device.h>
#include <zephyr/sys/sys_io.h>

#include <epg/zephyr/qdec.h>

#define DECODER(node, prop, idx) DEVICE_DT_GET(DT_PROP_BY_IDX(node, prop, idx)),

static const struct device *const decoders[] = {
	DT_FOREACH_PROP_ELEM(DT_PATH(zephyr_user), qdecs, DECODER)};

enum request {
	NONE,
	READ,
	FETCH,
	PRESET,
	WATCH,
	SUSPEND,
	RESUME,
	SKIPPED,
	POKE,
};

volatile uint32_t request;
/* The request that was completed last. */
volatile uint32_t done;
/* Number of reads of all decoders during the request WATCH, and of reads that failed. */
volatile uint32_t rounds;
volatile uint32_t failures;

volatile int32_t errors[ARRAY_SIZE(decoders)];
volatile int64_t positions[ARRAY_SIZE(decoders)];
volatile int64_t presets[ARRAY_SIZE(decoders)];
volatile int32_t angles[2 * ARRAY_SIZE(decoders)];
volatile int32_t skipped[ARRAY_SIZE(decoders)];
/* A write to a register that bypasses the drivers. */
volatile uint32_t poke_address;
volatile uint32_t poke_value;

static int fetch(size_t n)
{
	struct sensor_value angle;
	int ret;

	ret = sensor_sample_fetch(decoders[n]);
	if (ret < 0) {
		return ret;
	}

	ret = sensor_channel_get(decoders[n], SENSOR_CHAN_ROTATION, &angle);
	angles[2 * n] = angle.val1;
	angles[2 * n + 1] = angle.val2;

	return ret;
}

static int read(size_t n)
{
	int64_t count = 0;
	int ret = epg_qdec_get_count(decoders[n], &count);

	positions[n] = count;

	return ret;
}

static int look_for_skips(size_t n)
{
	struct sensor_value value = {0};
	int ret = sensor_attr_get(decoders[n], SENSOR_CHAN_ROTATION,
				  (enum sensor_attribute)SENSOR_ATTR_EPG_QDEC_SKIPPED, &value);

	skipped[n] = value.val1;

	return ret;
}

static int serve(uint32_t what, size_t n)
{
	switch (what) {
	case READ:
		return read(n);
	case FETCH:
		return fetch(n);
	case PRESET:
		return epg_qdec_set_count(decoders[n], presets[n]);
	case SUSPEND:
		return pm_device_action_run(decoders[n], PM_DEVICE_ACTION_SUSPEND);
	case RESUME:
		return pm_device_action_run(decoders[n], PM_DEVICE_ACTION_RESUME);
	case POKE:
		sys_write32(poke_value, poke_address);
		return 0;
	case SKIPPED:
		return look_for_skips(n);
	default:
		return -EINVAL;
	}
}

static void watch(void)
{
	while (request == WATCH) {
		for (size_t n = 0; n < ARRAY_SIZE(decoders); n++) {
			if (read(n) < 0) {
				failures++;
			}
		}
		rounds++;
	}
}

int main(void)
{
	for (size_t n = 0; n < ARRAY_SIZE(decoders); n++) {
		errors[n] = device_is_ready(decoders[n]) ? 0 : -ENODEV;
	}

	while (true) {
		const uint32_t what = request;

		if (what == WATCH) {
			watch();
			done = WATCH;
		} else if (what != NONE) {
			for (size_t n = 0; n < ARRAY_SIZE(decoders); n++) {
				errors[n] = serve(what, n);
			}
			request = NONE;
			done = what;
		}
		if (IS_ENABLED(CONFIG_FIRMWARE_SLEEPS)) {
			k_msleep(1);
		}
	}

	return 0;
}
